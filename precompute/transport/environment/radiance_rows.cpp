#include "precompute/transport/environment/radiance_rows.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <sstream>
#include <string>

namespace lightwell::transport {
namespace {

using Rgbe = std::array<uint8_t, 4>;

constexpr size_t kMaxHeaderLine = 4096, kMaxHeaderBytes = 1 << 20;
constexpr int kMinRunLengthWidth = 8, kMaxRunLengthWidth = 32767;  // widths outside are never stored component by component

struct Header {
  int width = 0, height = 0;
  bool bottom_up = false, right_to_left = false, xyz = false;
  Vec3d scale{1, 1, 1};  // from stored values to radiance
  std::streamoff pixels_at = 0;
};

/// value * 2^exponent of a shared exponent.
Rgb decode(const Rgbe& p) {
  if (p[3] == 0) return {0, 0, 0};
  const float scale = std::ldexp(1.0f, int(p[3]) - 136);
  return {p[0] * scale, p[1] * scale, p[2] * scale};
}

/// CIE XYZ (equal-energy white, as Radiance has it) to Rec. 709 primaries.
Rgb rgbFromXyz(const Rgb& c) {
  return {2.6904f * c.x - 1.2759f * c.y - 0.4138f * c.z, -1.0221f * c.x + 1.9783f * c.y + 0.0438f * c.z,
          0.0612f * c.x - 0.2245f * c.y + 1.1633f * c.z};
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file.string()), in_(file, std::ios::binary) {
    if (!in_) throw InputError(file_, "", "cannot be read");
  }
  [[noreturn]] void fail(const std::string& place, const std::string& reason) const { throw InputError(file_, place, reason); }

  std::string line() {
    std::string text;
    for (int c; (c = in_.get()) != '\n';) {
      if (c == EOF) fail("header", "the file ends inside the header");
      if (text.size() >= kMaxHeaderLine) fail("header", "a line of more than " + std::to_string(kMaxHeaderLine) + " bytes");
      text.push_back(char(c));
    }
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }
  std::streamoff position() { return in_.tellg(); }
  void seek(std::streamoff position) { in_.clear(), in_.seekg(position); }

  uint8_t byte() {
    const int c = in_.rdbuf()->sbumpc();
    if (c == EOF) fail(place(), "the file ends here");
    return uint8_t(c);
  }
  Rgbe pixel() {
    Rgbe p;
    for (uint8_t& b : p) b = byte();
    return p;
  }
  void setRow(int row) { row_ = row; }
  std::string place() const { return "scan line " + std::to_string(row_); }

 private:
  std::string file_;
  std::ifstream in_;
  int row_ = 0;
};

std::vector<double> numbers(std::string_view text) {
  std::istringstream in{std::string(text)};
  in.imbue(std::locale::classic());
  std::vector<double> values;
  for (double v; in >> v;) values.push_back(v);
  return values;
}

/// "-Y 512 +X 1024": the slow axis first. Returns false when the line is something else.
bool parseResolution(const Reader& reader, const std::string& line, Header& header) {
  std::istringstream in(line);
  std::string slow, fast;
  long slow_size = 0, fast_size = 0;
  if (!(in >> slow >> slow_size >> fast >> fast_size)) return false;
  const auto isAxis = [](const std::string& s, char axis) { return s.size() == 2 && (s[0] == '+' || s[0] == '-') && s[1] == axis; };
  if (isAxis(slow, 'X') && isAxis(fast, 'Y'))
    reader.fail("header", "scan lines run along columns (" + line + "); rotate the picture first");
  if (!isAxis(slow, 'Y') || !isAxis(fast, 'X')) return false;
  if (!isUsableMapSize(fast_size, slow_size))
    reader.fail("header", "unusable size " + std::to_string(fast_size) + " x " + std::to_string(slow_size));
  header.height = int(slow_size), header.width = int(fast_size);
  header.bottom_up = slow[0] == '+';
  header.right_to_left = fast[0] == '-';
  return true;
}

Header readHeader(Reader& reader, const std::string& file, Diagnostics& diagnostics) {
  Header header;
  if (!reader.line().starts_with("#?")) reader.fail("header", "does not begin with #?RADIANCE or #?RGBE");
  bool format_seen = false;
  size_t bytes = 0;
  for (std::string line = reader.line(); !line.empty(); line = reader.line()) {
    if ((bytes += line.size() + 1) > kMaxHeaderBytes) reader.fail("header", "does not end");
    const size_t equals = line.find('=');
    if (line[0] == '#' || equals == std::string::npos) continue;
    const std::string key = line.substr(0, equals), value = line.substr(equals + 1);
    const std::vector<double> values = numbers(value);
    if (key == "FORMAT") {
      format_seen = true;
      header.xyz = value.find("32-bit_rle_xyze") != std::string::npos;
      if (!header.xyz && value.find("32-bit_rle_rgbe") == std::string::npos) reader.fail("header", "unknown FORMAT " + value);
    } else if (key == "EXPOSURE" || key == "COLORCORR") {  // several multiply; pixels were multiplied by them
      const size_t wanted = key == "EXPOSURE" ? 1 : 3;
      if (values.size() < wanted) reader.fail("header", key + " is not a number: " + value);
      for (int c = 0; c < 3; ++c) {
        const double factor = values[wanted == 1 ? 0 : size_t(c)];
        if (!(factor > 1e-12 && factor < 1e12)) reader.fail("header", "unusable " + key + " " + value);
        header.scale[c] /= factor;
      }
    } else if (key == "PRIMARIES" && std::any_of(values.begin(), values.end(), [](double v) { return v != 0; })) {
      constexpr std::array rec709 = {0.64, 0.33, 0.3, 0.6, 0.15, 0.06};
      bool close = values.size() >= rec709.size();
      for (size_t i = 0; close && i < rec709.size(); ++i) close = std::abs(values[i] - rec709[i]) < 0.02;
      if (!close) diagnostics.warn(file, "PRIMARIES are not those of Rec. 709; taken as if they were");
    } else if (key == "GAMMA" && !values.empty() && values[0] != 1) {
      diagnostics.warn(file, "GAMMA " + value + " ignored: pixels are taken as linear");
    }
  }
  if (!format_seen) diagnostics.warn(file, "no FORMAT in the header; taken as 32-bit_rle_rgbe");
  const std::string resolution = reader.line();
  if (!parseResolution(reader, resolution, header)) reader.fail("header", "no resolution line (\"-Y height +X width\")");
  header.pixels_at = reader.position();
  return header;
}

/// Component after component, each in runs (Radiance 2.0 and later); `first` holds 2, 2, width.
void readComponents(Reader& reader, const Rgbe& first, std::vector<Rgbe>& pixels) {
  const size_t width = pixels.size();
  if (size_t(first[2]) * 256 + first[3] != width)
    reader.fail(reader.place(), "is " + std::to_string(first[2] * 256 + first[3]) + " texels long instead of " + std::to_string(width));
  for (int component = 0; component < 4; ++component) {
    for (size_t x = 0; x < width;) {
      const uint8_t code = reader.byte();
      const bool is_run = code > 128;
      const size_t count = is_run ? size_t(code) - 128 : code;
      if (count == 0 || count > width - x) reader.fail(reader.place(), "a run passes the end of the line");
      uint8_t value = is_run ? reader.byte() : 0;
      for (size_t i = 0; i < count; ++i) {
        if (!is_run) value = reader.byte();
        pixels[x++][size_t(component)] = value;
      }
    }
  }
}

/// Whole pixels; 1, 1, 1, n repeats the one before n times, and repeats in a row are the higher bytes of one count.
void readPixels(Reader& reader, Rgbe first, std::vector<Rgbe>& pixels) {
  int shift = 0;
  Rgbe pixel = first;
  for (size_t x = 0;;) {
    if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
      const size_t count = shift < 32 ? size_t(pixel[3]) << shift : pixels.size() + 1;
      if (x == 0 || count > pixels.size() - x)
        reader.fail(reader.place(), x == 0 ? "begins with a repeat" : "a run passes the end of the line");
      std::fill_n(pixels.begin() + long(x), count, pixels[x - 1]);
      x += count;
      shift += 8;
    } else {
      pixels[x++] = pixel;
      shift = 0;
    }
    if (x == pixels.size()) return;
    pixel = reader.pixel();
  }
}

class RadianceRows : public RowSource {
 public:
  RadianceRows(const std::filesystem::path& file, Diagnostics& diagnostics)
      : reader_(file), header_(readHeader(reader_, file.string(), diagnostics)) {}
  int width() const override { return header_.width; }
  int height() const override { return header_.height; }

  void visitRows(const RowVisitor& visit) override {
    reader_.seek(header_.pixels_at);
    std::vector<Rgbe> pixels(size_t(header_.width));
    std::vector<Rgb> radiance_rgb(pixels.size());
    for (int line = 0; line < header_.height; ++line) {
      const int row = header_.bottom_up ? header_.height - 1 - line : line;
      reader_.setRow(row);
      const Rgbe first = reader_.pixel();
      const bool may_be_components = header_.width >= kMinRunLengthWidth && header_.width <= kMaxRunLengthWidth;
      if (may_be_components && first[0] == 2 && first[1] == 2 && first[2] < 128)
        readComponents(reader_, first, pixels);
      else
        readPixels(reader_, first, pixels);
      for (size_t x = 0; x < pixels.size(); ++x) {
        Rgb value = decode(pixels[x]);
        if (header_.xyz) value = rgbFromXyz(value);
        for (int c = 0; c < 3; ++c) value[c] = float(value[c] * header_.scale[c]);
        if (header_.xyz)  // colours outside of Rec. 709, no damage
          for (int c = 0; c < 3; ++c) value[c] = std::max(value[c], 0.0f);
        radiance_rgb[header_.right_to_left ? pixels.size() - 1 - x : x] = value;
      }
      visit(row, radiance_rgb);
    }
  }

 private:
  Reader reader_;
  Header header_;
};

}  // namespace

std::unique_ptr<RowSource> openRadianceRows(const std::filesystem::path& file, Diagnostics& diagnostics) {
  return std::make_unique<RadianceRows>(file, diagnostics);
}

}  // namespace lightwell::transport
