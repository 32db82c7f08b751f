// lightwell compare: the errors of one irradiance map against another.
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/error_picture.h"
#include "precompute/core/image.h"
#include "precompute/transport/compare.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

struct Options {
  fs::path reference, candidate;
  std::optional<fs::path> second_reference, picture;
  bool json = false;
};

void run(Session& session, const Options& options) {
  if (options.picture) checkWritable(*options.picture);
  const auto read = [](const fs::path& file) {
    checkReadable(file);
    return readExr(file);
  };
  const ImageRgba reference = read(options.reference), candidate = read(options.candidate);
  std::optional<ImageRgba> second;
  if (options.second_reference) second = read(*options.second_reference);
  const transport::MapError e = transport::compareMaps(reference, candidate, second ? &*second : nullptr);
  if (options.picture) writeOutput(session, *options.picture, [&] { render::writePng(*options.picture, errorPicture(reference, second ? &*second : nullptr, candidate)); });
  // A map without a lit texel has no relative error: JSON has null for it.
  const auto number = [](double value) { return std::isfinite(value) ? json(value) : json(nullptr); };
  if (options.json) {
    printJson({{"reference", options.reference.string()},
               {"candidate", options.candidate.string()},
               {"texels", e.texels},
               {"missing", e.missing},
               {"nonfinite", e.nonfinite},
               {"negative", e.negative},
               {"relrmse", number(e.relrmse)},
               {"texrel", number(e.texrel)},
               {"bias", number(e.bias)},
               {"p99", number(e.p99)},
               {"max", number(e.max)}});
    return;
  }
  const auto percent = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g %%", 100 * value);
    return std::isfinite(value) ? std::string(text) : std::string("undefined");
  };
  std::printf("relrmse %s, texrel %s, bias %s, p99 %s, max %s over %zu texels\n", percent(e.relrmse).c_str(), percent(e.texrel).c_str(),
              percent(e.bias).c_str(), percent(e.p99).c_str(), percent(e.max).c_str(), e.texels);
  if (e.missing || e.nonfinite || e.negative)
    std::printf("%zu texels missing, %zu not finite, %zu negative\n", e.missing, e.nonfinite, e.negative);
}

}  // namespace

void addCompare(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("compare", "Errors of an irradiance map against a reference, over texels covered in both");
  command->add_option("reference", options->reference, "Reference map r")->required()->type_name("REF.exr");
  command->add_option("candidate", options->candidate, "Map to judge, c")->required()->type_name("C.exr");
  command->add_option("--second-reference", options->second_reference,
                      "Another noisy reference, independent of the first: the references' own noise then drops out of the errors")
      ->type_name("REF2.exr");
  command->add_option("--picture", options->picture, "Also show the errors, five times larger: red where the map is too bright, blue where it is too dark, grey where nothing is covered")
      ->type_name("FILE.png");
  command->add_flag("--json", options->json, "Print JSON (schemas/compare.schema.json)");
  command->footer(R"(relrmse = rms(c - r) / rms(r): what the bright parts are off by.
texrel = sqrt(mean(((c - r) / (r + 0.1 mean r))^2)): the error seen in each texel, dark ones too.
bias = mean c / mean r - 1. p99 and max are of |c - r| / rms(r).

Example:
  lightwell compare reference.exr evaluated.exr --json)");
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
