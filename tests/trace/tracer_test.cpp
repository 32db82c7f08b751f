#include "precompute/trace/tracer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "precompute/core/random.h"
#include "tests/support/scenes.h"

namespace lightwell::trace {
namespace {

/// Independent uniform numbers of one test.
class Uniform {
 public:
  explicit Uniform(uint64_t seed) : seed_(seed) {}
  float operator()() { return Sampler(seed_, count_++).get1D(0, 0); }
  float operator()(float low, float high) { return low + (high - low) * (*this)(); }
  Vec3 inBox(float half) {
    const float x = (*this)(-half, half), y = (*this)(-half, half);
    return {x, y, (*this)(-half, half)};
  }
  Vec3 direction() {
    const float z = (*this)(-1, 1), phi = (*this)(0, 2 * kPi), r = std::sqrt(std::max(0.0f, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  uint64_t seed_, count_ = 0;
};

scene::Scene soup(int triangles, float extent, float size, uint64_t seed) {
  scene::Scene scene;
  Uniform uniform(seed);
  scene.materials.push_back(test::diffuse(0.5f));
  for (int i = 0; i < triangles; ++i) {
    const Vec3 center = uniform.inBox(extent);
    std::array<uint32_t, 3> corner;
    for (uint32_t& c : corner) {
      c = uint32_t(scene.mesh.positions.size());
      scene.mesh.positions.push_back(center + uniform.inBox(size));
      scene.mesh.normals.push_back(Vec3(0, 0, 1));
    }
    scene.mesh.triangles.push_back(corner);
    scene.mesh.triangle_material.push_back(0);
    scene.mesh.triangle_object.push_back(0);
  }
  return scene;
}

/// Möller and Trumbore's test in double precision.
bool intersect(const scene::Mesh& mesh, uint32_t triangle, const Ray& ray, double& t, double& u, double& v) {
  const Vec3d a(mesh.positions[mesh.triangles[triangle][0]]), b(mesh.positions[mesh.triangles[triangle][1]]),
      c(mesh.positions[mesh.triangles[triangle][2]]), o(ray.origin), d(ray.direction);
  const Vec3d e1 = b - a, e2 = c - a, p = d.cross(e2);
  const double determinant = e1.dot(p);
  if (determinant == 0) return false;
  const Vec3d s = o - a, q = s.cross(e1);
  u = s.dot(p) / determinant;
  v = d.dot(q) / determinant;
  t = e2.dot(q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && t > ray.t_min && t < ray.t_max;
}

std::vector<Hit> closest(const Tracer& tracer, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  tracer.closest(rays, hits);
  return hits;
}
std::vector<float> transmittance(const Tracer& tracer, const std::vector<Ray>& rays) {
  std::vector<float> result(rays.size());
  tracer.transmittance(rays, result);
  return result;
}

TEST(Tracer, AgreesWithBruteForceOnASoup) {
  const scene::Scene scene = soup(400, 6, 2, 11);
  const Tracer tracer(scene);
  Uniform uniform(12);
  std::vector<Ray> rays;
  for (int i = 0; i < 4000; ++i)
    rays.push_back({uniform.inBox(8), uniform.direction(), uniform() < 0.5f ? 0.0f : 1.0f, uniform() < 0.5f ? 4.0f : 100.0f});
  const std::vector<Hit> hits = closest(tracer, rays);
  const std::vector<float> free = transmittance(tracer, rays);
  int found = 0, edge_cases = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    double best_t = rays[i].t_max, best_u = 0, best_v = 0;
    uint32_t best = kNone;
    for (uint32_t triangle = 0; triangle < scene.mesh.triangles.size(); ++triangle) {
      double t, u, v;
      if (intersect(scene.mesh, triangle, rays[i], t, u, v) && t < best_t) best = triangle, best_t = t, best_u = u, best_v = v;
    }
    if (hits[i].triangle != best) {
      ++edge_cases;
      continue;
    }
    EXPECT_EQ(free[i], best == kNone ? 1.0f : 0.0f);
    if (best == kNone) continue;
    ++found;
    EXPECT_NEAR(hits[i].t, best_t, 1e-4);
    EXPECT_NEAR(hits[i].u, best_u, 1e-3);
    EXPECT_NEAR(hits[i].v, best_v, 1e-3);
    const auto& corner = scene.mesh.triangles[best];
    const auto& p = scene.mesh.positions;
    const Vec3 normal = (p[corner[1]] - p[corner[0]]).cross(p[corner[2]] - p[corner[0]]).normalized();
    EXPECT_EQ(hits[i].front, normal.dot(rays[i].direction) < 0);
    EXPECT_LT((hits[i].geometric_normal - (hits[i].front ? normal : -normal)).length(), 1e-3f);
    EXPECT_LE(hits[i].geometric_normal.dot(rays[i].direction), 0.0f);
  }
  EXPECT_GT(found, 1000);
  EXPECT_LE(edge_cases, 2);  // rays through an edge within rounding
}

/// A closed sphere of small triangles, its vertices shared.
scene::Scene sphere(int rings, float radius, const Vec3& center) {
  scene::Scene scene;
  scene.materials.push_back(test::diffuse(0.5f));
  const auto add = [&](float theta, float phi) {
    const Vec3 n(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
    scene.mesh.positions.push_back(center + n * radius);
    scene.mesh.normals.push_back(-n);
    return uint32_t(scene.mesh.positions.size() - 1);
  };
  const int sectors = 2 * rings;
  const uint32_t top = add(0, 0), bottom = add(kPi, 0);
  for (int j = 1; j < rings; ++j)
    for (int i = 0; i < sectors; ++i) add(kPi * float(j) / float(rings), 2 * kPi * float(i) / float(sectors));
  const auto at = [&](int j, int i) { return j == 0 ? top : j == rings ? bottom : uint32_t(2 + (j - 1) * sectors + i % sectors); };
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < sectors; ++i) {
      if (j > 0) scene.mesh.triangles.push_back({at(j, i), at(j, i + 1), at(j + 1, i)});
      if (j + 1 < rings) scene.mesh.triangles.push_back({at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)});
    }
  scene.mesh.triangle_material.assign(scene.mesh.triangles.size(), 0);
  scene.mesh.triangle_object.assign(scene.mesh.triangles.size(), 0);
  return scene;
}

/// How many of `count` rays from within a sphere come out of it; aimed at shared edges, at shared corners, or anywhere.
enum class Aim { edge, corner, anywhere };
size_t escapes(const scene::Scene& scene, const Vec3& center, Aim aim, int count) {
  const Tracer tracer(scene);
  const scene::Mesh& mesh = scene.mesh;
  Uniform uniform(21);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const auto& corner = mesh.triangles[std::min(size_t(uniform() * mesh.triangles.size()), mesh.triangles.size() - 1)];
    const Vec3 a = mesh.positions[corner[0]], b = mesh.positions[corner[1]];
    const Vec3 origin = center + uniform.inBox(1.5f);
    const Vec3 target = aim == Aim::edge ? a + (b - a) * uniform() : aim == Aim::corner ? a : origin + uniform.direction();
    rays.push_back({origin, (target - origin).normalized()});
  }
  size_t escaped = 0;
  for (const Hit& hit : closest(tracer, rays)) escaped += hit.triangle == kNone;
  for (const float free : transmittance(tracer, rays)) escaped += free > 0;
  return escaped;
}

TEST(Tracer, AClosedMeshIsWatertight) {
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(3, -2, 4)}) {
    const scene::Scene scene = sphere(40, 4, center);
    EXPECT_EQ(escapes(scene, center, Aim::anywhere, 500000), 0u);
    EXPECT_EQ(escapes(scene, center, Aim::edge, 500000), 0u);
    // Aimed exactly at a corner, the rounded edge tests of the triangles around it may all say "outside" (about 0.2 % of such rays).
    EXPECT_LE(escapes(scene, center, Aim::corner, 100000), 1000u);
  }
}

TEST(Tracer, RaysThatStartOnAWallOfAClosedBoxStayInsideAndOffTheWall) {
  for (const Vec3& half : {Vec3(8, 8, 8), Vec3(8, 0.01f, 8), Vec3(0.5f, 0.25f, 0.125f)}) {
    const scene::Scene scene = test::closedBox(half, test::diffuse(0.5f));
    const Tracer tracer(scene);
    Uniform uniform(31);
    size_t escaped = 0, self_hits = 0, back_faces = 0;
    for (int batch = 0; batch < 40; ++batch) {
      std::vector<Ray> rays;
      std::vector<uint32_t> wall;
      for (int i = 0; i < 5000; ++i) {
        const uint32_t quad = uint32_t(uniform() * 6) % 6;
        const auto& p = scene.mesh.positions;
        const uint32_t first = scene.objects[quad].first_vertex;
        const Vec3 position = p[first] + (p[first + 1] - p[first]) * uniform() + (p[first + 3] - p[first]) * uniform();
        const Vec3 normal = scene.mesh.normals[first];
        Vec3 direction = uniform.direction();
        if (direction.dot(normal) < 0) direction = -direction;
        rays.push_back({Tracer::offsetOrigin(position, normal, direction), direction});
        wall.push_back(quad);
      }
      const std::vector<Hit> hits = closest(tracer, rays);
      for (size_t i = 0; i < hits.size(); ++i) {
        escaped += hits[i].triangle == kNone;
        self_hits += hits[i].triangle != kNone && hits[i].triangle / 2 == wall[i];
        back_faces += hits[i].triangle != kNone && !hits[i].front;
      }
    }
    EXPECT_EQ(self_hits, 0u) << half;
    EXPECT_LE(escaped + back_faces, 2u) << half;  // from within the offset of an edge a ray may start behind the next wall
  }
}

TEST(Tracer, OffsetClearsSlopedTriangles) {
  const scene::Scene scene = soup(2000, 7, 4, 41);
  const Tracer tracer(scene);
  Uniform uniform(42);
  size_t self_hits = 0;
  for (uint32_t triangle = 0; triangle < 2000; ++triangle)
    for (int i = 0; i < 20; ++i) {
      const auto& corner = scene.mesh.triangles[triangle];
      const auto& p = scene.mesh.positions;
      const Vec2 b = sampleTriangle({uniform(), uniform()});
      const Vec3 position = p[corner[0]] * (1 - b.x - b.y) + p[corner[1]] * b.x + p[corner[2]] * b.y;
      const Vec3 cross = (p[corner[1]] - p[corner[0]]).cross(p[corner[2]] - p[corner[0]]);
      if (cross.length() < 0.05f) continue;  // the normal of a needle is itself uncertain
      const Vec3 direction = uniform.direction();
      const Ray ray{Tracer::offsetOrigin(position, cross.normalized(), direction), direction};
      self_hits += closest(tracer, {ray})[0].triangle == triangle;
    }
  EXPECT_EQ(self_hits, 0u);
}

TEST(Tracer, RaysOfNothingAreMisses) {
  const scene::Scene scene = test::closedBox(Vec3(5), test::diffuse(0.5f));
  const Tracer tracer(scene);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const Vec3 x(1, 0, 0), o(0, 0, 0);
  const std::vector<Ray> rays = {{o, x, 0, 0},           {o, x, 0, nan},           {o, x, nan, infinity},        {o, x, 0, -1},
                                 {Vec3(nan, 0, 0), x},   {o, Vec3(0, nan, 0)},     {o, Vec3(0, 0, 0)},           {Vec3(infinity, 0, 0), x},
                                 {o, Vec3(0, infinity, 0)}, {o, x, 6, infinity}};
  for (const Hit& hit : closest(tracer, rays)) EXPECT_EQ(hit.triangle, kNone);
  for (const float free : transmittance(tracer, rays)) EXPECT_EQ(free, 1.0f);
}

TEST(Tracer, AnEmptySceneIsAllFree) {
  const scene::Scene scene;
  const Tracer tracer(scene);
  EXPECT_EQ(closest(tracer, {{Vec3(0, 0, 0), Vec3(1, 0, 0)}})[0].triangle, kNone);
  EXPECT_EQ(transmittance(tracer, {{Vec3(0, 0, 0), Vec3(1, 0, 0)}})[0], 1.0f);
}

TEST(Tracer, BothSidesOfASingleSidedSurfaceOcclude) {
  test::SceneBuilder builder;
  builder.quad(Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), builder.material(test::diffuse(0.5f)));
  const scene::Scene scene = builder.take();
  const Tracer tracer(scene);
  const std::vector<Ray> rays = {{Vec3(0.1f, 0.2f, 1), Vec3(0, 0, -2), 0, 1}, {Vec3(0.1f, 0.2f, -1), Vec3(0, 0, 2), 0, 1}};
  const std::vector<Hit> hits = closest(tracer, {{rays[0].origin, Vec3(0, 0, -1)}, {rays[1].origin, Vec3(0, 0, 1)}});
  EXPECT_TRUE(hits[0].front);
  EXPECT_FALSE(hits[1].front);
  EXPECT_GT(hits[0].geometric_normal.z, 0);
  EXPECT_LT(hits[1].geometric_normal.z, 0);
  EXPECT_EQ(transmittance(tracer, rays), (std::vector<float>{0, 0}));
  // The same segments cut short of the surface are free: t is in multiples of the direction.
  EXPECT_EQ(transmittance(tracer, {{rays[0].origin, Vec3(0, 0, -2), 0, 0.49f}})[0], 1.0f);
}

/// Panes of alpha 0.25 and 0.5 before an opaque wall, an opaque triangle list interleaved with the others.
scene::Scene panes(scene::AlphaMode mode) {
  test::SceneBuilder builder;
  const auto pane = [&](float z, float alpha, scene::AlphaMode alpha_mode) {
    scene::Material material = test::diffuse(0.5f);
    material.alpha = alpha;
    material.alpha_mode = alpha_mode;
    builder.quad(Vec3(-1, -1, z), Vec3(2, 0, 0), Vec3(0, 2, 0), builder.material(material));
  };
  pane(0, 1, scene::AlphaMode::opaque);
  pane(1, 0.25f, mode);
  pane(-1, 1, scene::AlphaMode::opaque);
  pane(2, 0.5f, mode);
  return builder.take();
}

TEST(Tracer, BlendedSurfacesAttenuateShadowsByTheProductOfWhatTheyPass) {
  const scene::Scene scene = panes(scene::AlphaMode::blend);
  const Tracer tracer(scene);
  const Vec3 down(0, 0, -1);
  const std::vector<float> free = transmittance(tracer, {{Vec3(0.3f, 0.1f, 3), down, 0, 2.5f},
                                                         {Vec3(0.3f, 0.1f, 3), down, 0, 1.5f},
                                                         {Vec3(0.3f, 0.1f, 3), down, 0, 3.5f},
                                                         {Vec3(0.3f, 0.1f, 3), down, 0, 0.5f}});
  EXPECT_EQ(free, (std::vector<float>{0.375f, 0.5f, 0, 1}));
}

TEST(Tracer, BlendedSurfacesStopAClosestRayAsOftenAsTheirAlphaSays) {
  const scene::Scene scene = panes(scene::AlphaMode::blend);
  const Tracer tracer(scene);
  constexpr int kRays = 20000;
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < kRays; ++i) rays.push_back({Vec3(0.3f, 0.1f, 3), Vec3(0, 0, -1), 0, 100, mixBits(i)});
  std::array<double, 4> share{};
  const std::vector<Hit> hits = closest(tracer, rays);
  for (const Hit& hit : hits) share[hit.triangle / 2] += 1.0 / kRays;
  EXPECT_NEAR(share[3], 0.5, 0.015);
  EXPECT_NEAR(share[1], 0.125, 0.01);
  EXPECT_NEAR(share[0], 0.375, 0.015);
  EXPECT_EQ(share[2], 0);
  // The decision belongs to the ray, not to the order or the batch.
  for (int i = 0; i < 100; ++i) EXPECT_EQ(closest(tracer, {rays[i]})[0].triangle, hits[i].triangle);
}

TEST(Tracer, ManyBlendedSurfacesAreEachCountedOnce) {
  // Long thin overlapping triangles, which a tree with spatial splits would keep in several leaves.
  scene::Scene scene = soup(300, 3, 5, 51);
  scene.materials[0].alpha_mode = scene::AlphaMode::blend;
  scene.materials[0].alpha = 0.125f;
  const Tracer tracer(scene);
  Uniform uniform(52);
  int edge_cases = 0;
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{uniform.inBox(6), uniform.direction(), 0, 5};
    double expected = 1;
    for (uint32_t triangle = 0; triangle < scene.mesh.triangles.size(); ++triangle) {
      double t, u, v;
      if (intersect(scene.mesh, triangle, ray, t, u, v)) expected *= 0.875;
    }
    const float free = transmittance(tracer, {ray})[0];
    if (std::abs(free / expected - 1) > 1e-4) ++edge_cases;
  }
  EXPECT_LE(edge_cases, 3);
}

TEST(Tracer, MaskIsCutOutExactlyAsTheTextureSays) {
  test::SceneBuilder builder;
  scene::Material leaf = test::diffuse(0.5f);
  leaf.alpha_mode = scene::AlphaMode::mask;
  leaf.base_color_texture = 0;
  builder.quad(Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), builder.material(leaf));
  scene::Scene scene = builder.take();
  scene::Texture stripes;  // left half solid, right half empty
  stripes.width = 8, stripes.height = 2;
  for (int i = 0; i < 16; ++i) stripes.rgba.insert(stripes.rgba.end(), {255, 255, 255, uint8_t(i % 8 < 4 ? 255 : 0)});
  stripes.wrap_u = stripes.wrap_v = scene::Texture::Wrap::clamp;
  scene.textures.push_back(stripes);
  const Tracer tracer(scene);
  for (float x = -0.95f; x < 1; x += 0.1f) {
    const Ray ray{Vec3(x, 0.13f, 1), Vec3(0, 0, -1), 0, 10, 7};
    EXPECT_EQ(transmittance(tracer, {ray})[0], x < 0 ? 0.0f : 1.0f) << x;
    EXPECT_EQ(closest(tracer, {ray})[0].triangle != kNone, x < 0) << x;
  }
}

TEST(Tracer, HitsDoNotDependOnBatchesOrThreads) {
  // Every triangle twice, so that the choice among coincident surfaces would show a difference between trees.
  scene::Scene scene = soup(20000, 6, 0.3f, 61);
  const size_t count = scene.mesh.triangles.size();
  for (size_t i = 0; i < count; ++i) {
    scene.mesh.triangles.push_back(scene.mesh.triangles[i]);
    scene.mesh.triangle_material.push_back(0);
    scene.mesh.triangle_object.push_back(0);
  }
  Uniform uniform(62);
  std::vector<Ray> rays;
  for (int i = 0; i < 50000; ++i) rays.push_back({uniform.inBox(6), uniform.direction()});
  const std::vector<Hit> expected = closest(Tracer(scene, 1), rays);
  for (const int threads : {0, 2, 5}) {
    const Tracer tracer(scene, threads);
    size_t different = 0;
    for (size_t begin = 0; begin < rays.size(); begin += 777) {
      const std::vector<Ray> part(rays.begin() + begin, rays.begin() + std::min(begin + 777, rays.size()));
      const std::vector<Hit> hits = closest(tracer, part);
      for (size_t i = 0; i < part.size(); ++i) {
        const Hit &a = hits[i], &b = expected[begin + i];
        different += a.triangle != b.triangle || a.t != b.t || a.u != b.u || a.v != b.v;
      }
    }
    EXPECT_EQ(different, 0u) << threads << " threads";
  }
}

TEST(Tracer, CountsRays) {
  const scene::Scene scene = test::closedBox(Vec3(5), test::diffuse(0.5f));
  const Tracer tracer(scene);
  const std::vector<Ray> rays(30, Ray{Vec3(0, 0, 0), Vec3(1, 0, 0)});
  closest(tracer, rays);
  closest(tracer, rays);
  transmittance(tracer, rays);
  EXPECT_EQ(tracer.counts().closest, 60u);
  EXPECT_EQ(tracer.counts().occlusion, 30u);
}

TEST(Portals, AreMetWhereTheirLeavesAreLeft) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.5f));
  builder.quad({0, 0, 0}, {4, 0, 0}, {0, 2, 0}, wall).quad({0, 0, -1}, {4, 0, 0}, {0, 2, 0}, wall);
  scene::Scene scene = builder.take();
  scene.portals.push_back({.name = "door", .first_triangle = 0, .triangle_count = 2, .axis = {0.25f, 0, 0}, .strips = 8});
  for (const float open : {0.0f, 0.3f, 1.0f}) {
    const Tracer tracer(scene, 1, {open});
    for (const float at : {0.01f, 0.29f, 0.31f, 0.99f}) {
      const Ray ray{.origin = {4 * at, 1, 1}, .direction = {0, 0, -1}};
      const bool gone = at < open;
      Hit hit;
      tracer.closest({&ray, 1}, {&hit, 1});
      EXPECT_EQ(hit.triangle / 2, gone ? 1u : 0u) << open << " " << at;
      Ray segment = ray;
      segment.t_max = 1.5f;
      float transmittance = -1;
      tracer.transmittance({&segment, 1}, {&transmittance, 1});
      EXPECT_EQ(transmittance, gone ? 1.0f : 0.0f) << open << " " << at;
    }
  }
  EXPECT_THROW(Tracer(scene, 1, {0.5f, 0.5f}), std::logic_error);
}

}  // namespace
}  // namespace lightwell::trace
