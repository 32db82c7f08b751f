#include "precompute/transport/environment/openexr_rows.h"

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <array>
#include <string>

#include "precompute/core/exr_check.h"

namespace lightwell::transport {
namespace {

constexpr int64_t kMaxWindow = 1 << 20;            // texels along a side of the data window
constexpr int64_t kMaxRowBytes = int64_t{1} << 26;  // of all channels together
constexpr int64_t kMaxTileSide = 8192;
// The rows that are packed together, or a row of tiles. OpenEXR holds up to three times as much while it reads: for rows of 65,536 RGBA halfs packed by 256, 0.4 GB.
constexpr int64_t kMaxBlockBytes = int64_t{1} << 27;

/// The names of the channels that carry red, green and blue; all the same for luminance alone.
struct ColorChannels {
  std::array<std::string, 3> names;
};

std::optional<ColorChannels> findColor(const Imf::ChannelList& channels) {
  const auto has = [&](const std::string& name) { return channels.findChannel(name) != nullptr; };
  std::vector<std::string> prefixes = {""};
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    const std::string name = it.name();
    if (const size_t dot = name.rfind('.'); dot != std::string::npos) prefixes.push_back(name.substr(0, dot + 1));
  }
  for (const std::string& prefix : prefixes) {
    if (has(prefix + "R") && has(prefix + "G") && has(prefix + "B")) return ColorChannels{{prefix + "R", prefix + "G", prefix + "B"}};
    if (has(prefix + "Y") && !has(prefix + "RY") && !has(prefix + "BY")) return ColorChannels{{prefix + "Y", prefix + "Y", prefix + "Y"}};
  }
  return std::nullopt;
}

/// Of scan lines ("The OpenEXR File Layout", compression).
int rowsPackedTogether(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION: case Imf::RLE_COMPRESSION: case Imf::ZIPS_COMPRESSION: return 1;
    case Imf::ZIP_COMPRESSION: case Imf::PXR24_COMPRESSION: return 16;
    case Imf::DWAB_COMPRESSION: return 256;
    default: return 32;
  }
}

class OpenExrRows : public RowSource {
 public:
  OpenExrRows(const std::filesystem::path& file, Diagnostics& diagnostics)
      : name_(file.string()), file_(file.c_str(), 0), part_(choosePart()), channels_(*findColor(header().channels())) {
    checkSizes();
    if (Imf::hasEnvmap(header()) && Imf::envmap(header()) != Imf::ENVMAP_LATLONG)
      fail("header", "a cube map; only latitude-longitude maps are read");
    if (Imf::hasChromaticities(header())) {
      const Imf::Chromaticities given = Imf::chromaticities(header()), rec709;
      const auto far = [](const Imath::V2f& a, const Imath::V2f& b) { return (a - b).length() > 0.02f; };
      if (far(given.red, rec709.red) || far(given.green, rec709.green) || far(given.blue, rec709.blue))
        diagnostics.warn(name_, "chromaticities are not those of Rec. 709; taken as if they were");
    }
  }
  int width() const override { return int(displaySize().x); }
  int height() const override { return int(displaySize().y); }

  void visitRows(const RowVisitor& visit) override {
    const Imath::Box2i &display = header().displayWindow(), &data = header().dataWindow();
    std::vector<Rgb> stored(size_t(int64_t(data.max.x) - data.min.x + 1)), row(static_cast<size_t>(width()));
    Imf::InputPart in = openPart();
    const int64_t first = std::max(display.min.x, data.min.x), last = std::min(display.max.x, data.max.x);
    for (int64_t y = display.min.y; y <= display.max.y; ++y) {
      std::fill(row.begin(), row.end(), Rgb(0, 0, 0));
      if (y >= data.min.y && y <= data.max.y) {
        readStoredRow(in, int(y), stored);
        for (int64_t x = first; x <= last; ++x) row[size_t(x - display.min.x)] = stored[size_t(x - data.min.x)];
      }
      visit(int(y - display.min.y), row);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& reason) const { throw InputError(name_, place, reason); }
  const Imf::Header& header() const { return file_.header(part_); }
  Imath::Vec2<int64_t> displaySize() const {
    const Imath::Box2i& w = header().displayWindow();
    return {int64_t(w.max.x) - w.min.x + 1, int64_t(w.max.y) - w.min.y + 1};
  }

  /// OpenEXR looks at some of the header only now.
  Imf::InputPart openPart() {
    try {
      return Imf::InputPart(file_, part_);
    } catch (const std::exception& error) {
      fail("part " + std::to_string(part_), error.what());
    }
  }

  int choosePart() const {
    std::string seen;
    for (int part = 0; part < file_.parts(); ++part) {
      const Imf::Header& candidate = file_.header(part);
      const bool deep = candidate.hasType() && Imf::isDeepData(candidate.type());
      if (!deep && findColor(candidate.channels())) return part;
      if (deep) seen += " (deep data)";
      for (auto it = candidate.channels().begin(); it != candidate.channels().end(); ++it)
        if (seen.size() < 200) seen += std::string(" ") + it.name();
    }
    fail("channels", "no part has R, G and B, or Y alone; there are:" + seen);
  }

  void checkSizes() const {
    const auto [width, height] = displaySize();
    if (!isUsableMapSize(width, height))
      fail("displayWindow", "unusable size " + std::to_string(width) + " x " + std::to_string(height));
    const Imath::Box2i& data = header().dataWindow();
    const int64_t data_width = int64_t(data.max.x) - data.min.x + 1, data_height = int64_t(data.max.y) - data.min.y + 1;
    if (data_width < 1 || data_height < 1 || data_width > kMaxWindow || data_height > kMaxWindow)
      fail("dataWindow", "unusable size " + std::to_string(data_width) + " x " + std::to_string(data_height));
    int64_t texel_bytes = 0;
    for (auto it = header().channels().begin(); it != header().channels().end(); ++it) texel_bytes += it.channel().type == Imf::HALF ? 2 : 4;
    if (texel_bytes * data_width > kMaxRowBytes) fail("channels", "too many channels for rows of " + std::to_string(data_width));
    if (const int64_t rows = rowsPackedTogether(header().compression()); rows * texel_bytes * data_width > kMaxBlockBytes)
      fail("compression", "packs " + std::to_string(rows) + " rows of " + std::to_string(data_width) + " texels together, more than the limit of 128 MiB; store the map with ZIPS");
    for (const std::string& name : channels_.names) {
      const Imf::Channel& channel = *header().channels().findChannel(name);
      if (channel.xSampling != 1 || channel.ySampling != 1) fail("channel " + name, "subsampled");
    }
    if (header().hasTileDescription()) {
      const Imf::TileDescription& tiles = header().tileDescription();
      if (tiles.xSize < 1 || tiles.ySize < 1 || tiles.xSize > kMaxTileSide || tiles.ySize > kMaxTileSide ||
          int64_t(tiles.ySize) * data_width * texel_bytes > kMaxBlockBytes)
        fail("tiles", "unusable size " + std::to_string(tiles.xSize) + " x " + std::to_string(tiles.ySize));
    }
  }

  void readStoredRow(Imf::InputPart& in, int y, std::vector<Rgb>& stored) const {
    const bool luminance_only = channels_.names[0] == channels_.names[1];
    const Imath::Box2i window({header().dataWindow().min.x, y}, {header().dataWindow().max.x, y});
    try {
      Imf::FrameBuffer frame;
      for (int c = 0; c < (luminance_only ? 1 : 3); ++c)
        frame.insert(channels_.names[size_t(c)],
                     Imf::Slice::Make(Imf::FLOAT, &stored[0][c], window, sizeof(Rgb), sizeof(Rgb) * stored.size()));
      in.setFrameBuffer(frame);
      in.readPixels(y);
    } catch (const std::exception& error) {
      fail("row " + std::to_string(y), error.what());
    }
    if (luminance_only)
      for (Rgb& value : stored) value = Rgb(value.x);
  }

  std::string name_;
  Imf::MultiPartInputFile file_;
  int part_;
  ColorChannels channels_;
};

}  // namespace

std::unique_ptr<RowSource> openOpenExrRows(const std::filesystem::path& file, Diagnostics& diagnostics) {
  checkExrHeaders(file);
  try {
    return std::make_unique<OpenExrRows>(file, diagnostics);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(file.string(), "", error.what());
  }
}

}  // namespace lightwell::transport
