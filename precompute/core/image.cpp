#include "precompute/core/image.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <unistd.h>

#include <string>
#include <system_error>
#include <thread>

#include "precompute/core/error.h"
#include "precompute/core/exr_check.h"

namespace lightwell {
namespace {

constexpr int64_t kMaxPixels = int64_t{1} << 27;  // 2 GiB of floats: beyond any atlas or sky, within any machine
constexpr const char* kChannels[4] = {"R", "G", "B", "A"};

/// A sibling of `file`, so that the rename stays within one file system; unique among processes and threads.
std::filesystem::path temporarySibling(const std::filesystem::path& file) {
  std::filesystem::path temporary = file;
  temporary += ".tmp" + std::to_string(::getpid()) + "-" + std::to_string(std::hash<std::thread::id>{}(std::this_thread::get_id()));
  return temporary;
}

/// A frame buffer slice for component `channel` of pixels whose first one is at (min_x, min_y) of the data window.
Imf::Slice slice(std::array<float, 4>* pixels, int channel, int width, const Imath::Box2i& window, float fill) {
  return Imf::Slice::Make(Imf::FLOAT, pixels->data() + channel, window, sizeof(*pixels), sizeof(*pixels) * size_t(width), 1, 1, fill);
}

}  // namespace

void writeExr(const std::filesystem::path& file, const ImageRgba& image) {
  const auto fail = [&](const std::string& reason) { throw std::runtime_error(file.string() + ": cannot write: " + reason); };
  if (image.width <= 0 || image.height <= 0 || image.pixels.size() != size_t(image.width) * size_t(image.height))
    fail("the picture is " + std::to_string(image.width) + " x " + std::to_string(image.height) + " with " +
         std::to_string(image.pixels.size()) + " pixels");
  const std::filesystem::path temporary = temporarySibling(file);
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer frame;
    auto* pixels = const_cast<std::array<float, 4>*>(image.pixels.data());  // OpenEXR's slices are shared by readers and writers
    for (int c = 0; c < 4; ++c) {
      header.channels().insert(kChannels[c], Imf::Channel(Imf::FLOAT));
      frame.insert(kChannels[c], slice(pixels, c, image.width, header.dataWindow(), 0.0f));
    }
    {
      Imf::OutputFile out(temporary.c_str(), header, 0);
      out.setFrameBuffer(frame);
      out.writePixels(image.height);
    }
    std::filesystem::rename(temporary, file);
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    fail(error.what());
  }
}

ImageRgba readExr(const std::filesystem::path& file) {
  checkExrHeaders(file);
  try {
    Imf::InputFile in(file.c_str(), 0);
    const Imath::Box2i window = in.header().dataWindow();
    const int64_t width = int64_t(window.max.x) - window.min.x + 1, height = int64_t(window.max.y) - window.min.y + 1;
    if (width <= 0 || height <= 0 || width > kMaxPixels / height)
      throw InputError(file.string(), "header", "unusable size " + std::to_string(width) + " x " + std::to_string(height));

    const Imf::ChannelList& channels = in.header().channels();
    const bool luminance_only = !channels.findChannel("R") && !channels.findChannel("G") && !channels.findChannel("B");
    if (luminance_only && (!channels.findChannel("Y") || channels.findChannel("RY") || channels.findChannel("BY")))
      throw InputError(file.string(), "channels", "neither R, G, B nor luminance alone");
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
      if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
        throw InputError(file.string(), std::string("channel ") + channel.name(), "subsampled");

    ImageRgba image{int(width), int(height), std::vector<std::array<float, 4>>(size_t(width * height))};
    Imf::FrameBuffer frame;
    if (luminance_only) {
      frame.insert("Y", slice(image.pixels.data(), 0, image.width, window, 0.0f));
    } else {
      for (int c = 0; c < 3; ++c) frame.insert(kChannels[c], slice(image.pixels.data(), c, image.width, window, 0.0f));
    }
    frame.insert("A", slice(image.pixels.data(), 3, image.width, window, 1.0f));
    in.setFrameBuffer(frame);
    in.readPixels(window.min.y, window.max.y);
    if (luminance_only)
      for (auto& pixel : image.pixels) pixel[1] = pixel[2] = pixel[0];
    return image;
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(file.string(), "", error.what());
  }
}

}  // namespace lightwell
