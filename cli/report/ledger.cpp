#include "cli/report/ledger.h"

#include <algorithm>
#include <fstream>

#include "format/encode/atomic_file.h"

namespace lightwell::report {
namespace {

namespace fs = std::filesystem;
constexpr const char* kFile = "finished.json";

bool present(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

}  // namespace

Ledger::Ledger(const fs::path& folder, std::string key, bool fresh) : folder_(folder), key_(std::move(key)) {
  if (fresh) return;
  std::ifstream in(folder_ / kFile);
  const nlohmann::json json = nlohmann::json::parse(in, nullptr, false);
  try {
    if (!json.is_object() || json.at("key") != key_) return;
    const auto& maps = json.at("reference").at("maps");
    if (!present(folder_ / maps.at(0).get<std::string>()) || !present(folder_ / maps.at(1).get<std::string>())) return;
    reference = json.at("reference").get<Reference>();
    bakes_ = json.at("bakes").get<std::vector<Baked>>();
    sky = json.at("sky").get<std::vector<SkyAnswer>>(), shadowed_sky = json.at("shadowed_sky").get<std::vector<SkyAnswer>>();
    live_lamps = json.at("live_lamps").get<std::vector<LampAnswer>>();
    if (!json.at("rays").is_null()) rays = json.at("rays").get<RayRate>();
  } catch (const nlohmann::json::exception&) {  // of another version, or damaged: all is measured anew
    reference.reset(), rays.reset(), bakes_.clear(), sky.clear(), shadowed_sky.clear(), live_lamps.clear();
  }
}

const Baked* Ledger::find(const std::string& key) const {
  for (const Baked& baked : bakes_)
    if (baked.key == key && present(folder_ / baked.file) && std::all_of(baked.evaluated.begin(), baked.evaluated.end(), [&](const Evaluated& e) { return present(folder_ / e.map); })) return &baked;
  return nullptr;
}

void Ledger::add(const Baked& baked) {
  std::erase_if(bakes_, [&](const Baked& other) { return other.key == baked.key; });
  bakes_.push_back(baked);
}

void Ledger::save() const {
  const std::string text = nlohmann::json{{"key", key_}, {"reference", reference ? nlohmann::json(*reference) : nlohmann::json(nullptr)}, {"bakes", bakes_}, {"sky", sky}, {"shadowed_sky", shadowed_sky}, {"live_lamps", live_lamps},
                                          {"rays", rays ? nlohmann::json(*rays) : nlohmann::json(nullptr)}}
                               .dump(1);
  format::writeFileAtomically(folder_ / kFile, std::vector<uint8_t>(text.begin(), text.end()));
}

}  // namespace lightwell::report
