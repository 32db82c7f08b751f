#include "precompute/bake/atlas_tasks.h"

#include <algorithm>
#include <bit>
#include <string>

#include "precompute/atlas/validity.h"
#include "precompute/bake/bake.h"

namespace lightwell::bake {
namespace {

// Neighbouring small objects share a task: up to so many triangles of them.
constexpr uint32_t kTrianglesPerTask = 256;
constexpr size_t kSlotsPerTask = 8192;  // a few tenths of a second

/// Triangles are counted from the object's first one: where it lies in the mesh does not matter.
void writeCharts(ByteWriter& writer, const std::vector<atlas::Chart>& charts, uint32_t first_triangle) {
  std::vector<uint32_t> sizes, triangles;
  std::vector<atlas::PlanarTriangle> corners;
  std::vector<atlas::Vec2d> extents;
  for (const auto& chart : charts) {
    sizes.push_back(uint32_t(chart.triangles.size()));
    for (const uint32_t triangle : chart.triangles) triangles.push_back(triangle - first_triangle);
    corners.insert(corners.end(), chart.corners.begin(), chart.corners.end());
    extents.push_back(chart.extent);
  }
  writer.array(sizes);
  writer.array(triangles);
  writer.array(corners);
  writer.array(extents);
}

std::vector<atlas::Chart> readCharts(ByteReader& reader, const scene::Object& object) {
  const auto sizes = reader.array<uint32_t>(), triangles = reader.array<uint32_t>();
  const auto corners = reader.array<atlas::PlanarTriangle>();
  const auto extents = reader.array<atlas::Vec2d>();
  if (triangles.size() != object.triangle_count || corners.size() != triangles.size() || extents.size() != sizes.size())
    throw std::runtime_error("a task result is damaged");
  std::vector<atlas::Chart> charts(sizes.size());
  size_t next = 0;
  for (size_t i = 0; i < charts.size(); ++i) {
    if (sizes[i] > triangles.size() - next) throw std::runtime_error("a task result is damaged");
    for (const size_t end = next + sizes[i]; next < end; ++next) {
      charts[i].triangles.push_back(object.first_triangle + triangles[next]);
      charts[i].corners.push_back(corners[next]);
    }
    charts[i].extent = extents[i];
  }
  return charts;
}

std::vector<std::vector<atlas::Chart>> growInTasks(TaskRunner& tasks, const scene::Scene& scene, std::span<const size_t> objects,
                                                   float normal_deviation) {
  TaskGraph graph(productVersion());
  std::vector<TaskIndex> goals;
  std::vector<std::span<const size_t>> objects_of_task;
  for (size_t first = 0, end = 0; first < objects.size(); first = end) {
    uint32_t triangles = 0;
    do triangles += scene.objects[objects[end++]].triangle_count;
    while (end < objects.size() && triangles + scene.objects[objects[end]].triangle_count <= kTrianglesPerTask);
    const auto some = objects.subspan(first, end - first);
    goals.push_back(graph.add({"atlas/charts/" + std::to_string(goals.size()), "charts", "atlas/charts",
                               chartKey(scene, some).hex() + " " + std::to_string(std::bit_cast<uint32_t>(normal_deviation)), {},
                               double(triangles) + 1, [&scene, some, normal_deviation](const TaskInputs& in) {
                                 ByteWriter writer;
                                 for (const size_t object : some) {
                                   in.cancel.check();
                                   writeCharts(writer, atlas::growCharts(scene.mesh, scene.objects[object], normal_deviation),
                                               scene.objects[object].first_triangle);
                                 }
                                 return writer.take();
                               }}));
    objects_of_task.push_back(some);
  }
  std::vector<std::vector<atlas::Chart>> charts;
  const auto results = tasks.prepare(graph, goals);
  for (size_t task = 0; task < results.size(); ++task) {
    ByteReader reader(*results[task]);
    for (const size_t object : objects_of_task[task]) charts.push_back(readCharts(reader, scene.objects[object]));
  }
  return charts;
}

}  // namespace

atlas::ChartSource chartTasks(TaskRunner& tasks) {
  return [&tasks](const scene::Scene& scene, std::span<const size_t> objects, float normal_deviation) {
    return growInTasks(tasks, scene, objects, normal_deviation);
  };
}

std::vector<uint8_t> validSlotTasks(TaskRunner& tasks, const SceneKeys& keys, const atlas::Atlas& atlas, const scene::Scene& scene,
                                    const trace::Tracer& tracer, uint64_t seed) {
  TaskGraph graph(productVersion());
  std::vector<TaskIndex> goals;
  const size_t slots = atlas.slots.size();
  for (size_t first = 0; first < slots; first += kSlotsPerTask) {
    const size_t end = std::min(slots, first + kSlotsPerTask);
    goals.push_back(graph.add({"atlas/validity/" + std::to_string(goals.size()), "validity", "atlas/validity",
                               keys.geometry.hex() + " " + std::to_string(seed) + " [" + std::to_string(first) + ", " + std::to_string(end) + ")",
                               {}, double(end - first), [&, seed, first, end](const TaskInputs& in) {
                                 ByteWriter writer;
                                 std::vector<uint8_t> valid;
                                 constexpr size_t kPiece = 512;
                                 for (size_t i = first; i < end; i += kPiece) {
                                   in.cancel.check();
                                   const auto part = atlas::validSlots(atlas, scene, tracer, seed, i, std::min(end, i + kPiece));
                                   valid.insert(valid.end(), part.begin(), part.end());
                                 }
                                 writer.array(valid);
                                 return writer.take();
                               }}));
  }
  std::vector<uint8_t> valid;
  for (const Blob& part : tasks.prepare(graph, goals)) {
    const auto values = ByteReader(*part).array<uint8_t>();
    valid.insert(valid.end(), values.begin(), values.end());
  }
  if (valid.size() != slots) throw std::runtime_error("a task result is damaged");
  return valid;
}

}  // namespace lightwell::bake
