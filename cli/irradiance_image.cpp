#include "cli/irradiance_image.h"

#include <cstdio>

namespace lightwell::cli {

void addComponent(CLI::App& command, std::string& component) {
  command.add_option("--component", component, "direct (straight from lights and emitters), indirect (after a reflection), or their total")
      ->type_name("NAME")
      ->check(CLI::IsMember({"direct", "indirect", "total"}))
      ->capture_default_str();
}

transport::Component componentNamed(const std::string& name) {
  return name == "direct"     ? transport::Component::direct
         : name == "indirect" ? transport::Component::indirect
                              : transport::Component::total;
}

ImageRgba imageOfSlots(const scene::Mesh& mesh, const atlas::Atlas& atlas, int size, std::span<const Rgb> slot_rgb) {
  ImageRgba image{size, size, std::vector<std::array<float, 4>>(size_t(size) * size)};
  const std::vector<char> standing = atlas::standingSlots(mesh, atlas);
  for (size_t i = 0; i < atlas.slots.size(); ++i)
    image.pixels[atlas.slots[i].texel] = {slot_rgb[i].x, slot_rgb[i].y, slot_rgb[i].z, standing[i] ? 1.0f : 0.0f};
  return image;
}

ProgressMeter::ProgressMeter(Console& console, std::string stage)
    : console_(console), stage_(std::move(stage)), begin_(std::chrono::steady_clock::now()), last_(begin_) {}

void ProgressMeter::update(double fraction) {
  const auto now = std::chrono::steady_clock::now();
  std::lock_guard lock(mutex_);
  if (fraction <= highest_ || now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  highest_ = fraction;
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  char percent[16];
  std::snprintf(percent, sizeof percent, "%3.0f %%", 100 * fraction);
  console_.progress(stage_, std::string(percent) + "  " + stage_ + ", " + formatDuration(elapsed_s) +
                                (elapsed_s > 0.5 ? ", about " + formatDuration(elapsed_s / fraction * (1 - fraction)) + " left" : ""));
}

}  // namespace lightwell::cli
