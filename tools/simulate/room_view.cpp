#include "tools/simulate/room_view.h"

#include <algorithm>
#include <cmath>

namespace roomcal::tools {

namespace {
constexpr double kEdgeReach_px = 1.0;  // half a pixel's diagonal, and room for what is not linear

bool is_opening(const Sight& sight) { return sight.patch != nullptr && !sight.patch->mirror; }

Vec2 place_of(const Sight& sight, double distance, const Vec3& ray_room) {
  return sight.hit.plane->coordinates(sight.eye_room + distance * ray_room);
}
}  // namespace

LitScene::LitScene(const Scene& scene) : scene_(scene) {
  uint64_t seed = scene.seed * 1000;
  const auto add = [&](const Plane& plane) {
    skins_.push_back(std::make_unique<Skin>(Skin{PaintedPlane(plane, seed += 2), LightMap(scene, plane)}));
  };
  for (const Plane& wall : scene.walls) add(wall);
  for (const Body& body : scene.bodies) {
    for (const Plane& face : body.faces) add(face);
  }
}

const LitScene::Skin& LitScene::skin_of(const Hit& hit) const {
  if (hit.body == nullptr) return *skins_[static_cast<std::size_t>(hit.plane - scene_.walls.data())];
  std::size_t index = scene_.walls.size();
  for (const Body& body : scene_.bodies) {
    if (&body == hit.body) break;
    index += body.faces.size();
  }
  return *skins_[index + static_cast<std::size_t>(hit.plane - hit.body->faces.data())];
}

double LitScene::paper_radiance(const Hit& hit, const Vec2& q) const {
  return hit.body == nullptr && !hit.plane->decals.empty() ? kPaperAlbedo * skin_of(hit).light.at(q) : -1;
}

double LitScene::lamp_radiance(const Hit& hit, const Vec2& q) const {
  constexpr double kFacesDown = -0.9, kMounting_m = 0.02;
  if (hit.body != nullptr || hit.plane->normal.z() > kFacesDown) return 0;
  const Vec3 point_room = hit.plane->point(q);
  for (const Lamp& lamp : scene_.lamps) {
    const Vec3 offset = point_room - lamp.centre;
    const bool on_panel = (lamp.half_size - offset.head<2>().cwiseAbs()).minCoeff() > 0;
    if (on_panel && std::abs(offset.z()) < kMounting_m) return lamp.intensity / (4 * lamp.half_size.prod());
  }
  return 0;
}

LitPatch::LitPatch(const LitScene& lit, const Hit& hit, const Vec2& q, const Mat22& footprint)
    : lit_(lit), hit_(hit), skin_(lit.skin_of(hit)), paint_(skin_.paint, q, footprint) {}

double LitPatch::radiance(const Vec2& q, double sample_px, double& edge_px) const {
  const Paint paint = paint_.at(q, sample_px);
  edge_px = paint.edge_px;
  return paint.albedo * skin_.light.at(q) + lit_.lamp_radiance(hit_, q);
}

RoomView::RoomView(const LitScene& lit, const camera::Camera& camera, const SE3& T_room_cam)
    : lit_(lit), camera_(camera), T_room_cam_(T_room_cam) {}

bool RoomView::rays_of(double x, double y, PixelRays& rays_room) const {
  Vec3 bearing_cam;
  Mat32 J_px;
  if (!camera_.unproject(Vec2(x, y), bearing_cam, &J_px).ok()) return false;
  rays_room = {T_room_cam_.R * bearing_cam, T_room_cam_.R * J_px};
  return true;
}

bool RoomView::has_outline(const Sight& sight) const {
  const Scene& scene = lit_.scene();
  const Hit& hit = sight.hit;
  const PixelRays& rays = sight.rays;
  const Vec3 point = sight.eye_room + hit.distance * rays.direction;
  const double metres_per_px = hit.distance * rays.J_px.norm();
  const double reach = kEdgeReach_px * metres_per_px / std::max(0.02, -hit.plane->normal.dot(rays.direction));
  if (scene.bounded()) {  // one wall may hide another anywhere
    const Plane* in_middle = cast_flat(scene, sight.eye_room, rays.direction).plane;
    for (const double dx : {-0.5, 0.5})
      for (const double dy : {-0.5, 0.5})
        if (cast_flat(scene, sight.eye_room, rays.at(dx, dy)).plane != in_middle) return true;
    return false;
  }
  if (hit.body == nullptr) {
    for (const Plane& wall : scene.walls) {
      if (&wall != hit.plane && wall.signed_distance(point) < reach) return true;
    }
  }
  for (const Body& body : scene.bodies) {
    const Hit at_centre = cast_at_body(body, sight.eye_room, rays.direction);
    for (const double dx : {-0.5, 0.5}) {
      for (const double dy : {-0.5, 0.5}) {
        if (cast_at_body(body, sight.eye_room, rays.at(dx, dy)).plane != at_centre.plane) return true;
      }
    }
  }
  return false;
}

bool RoomView::has_rim(const PixelRays& rays_room, const Sight& sight) const {
  const auto patched = [](const Plane& wall) { return !wall.patches.empty(); };
  const Scene& scene = lit_.scene();
  if (std::none_of(scene.walls.begin(), scene.walls.end(), patched)) return false;
  for (const double dx : {-0.5, 0.5})
    for (const double dy : {-0.5, 0.5})
      if (look(scene, T_room_cam_.t, {rays_room.at(dx, dy), rays_room.J_px}).patch != sight.patch) return true;
  return false;
}

float RoomView::sample_alone(const Vec3& ray_room, const Mat22& footprint) const {
  const Sight sight = look(lit_.scene(), T_room_cam_.t, {ray_room, Mat32::Zero()});
  if (sight.hit.plane == nullptr || is_opening(sight)) return 0;  // past the end of an open room
  const Vec2 place = place_of(sight, sight.hit.distance, sight.rays.direction);
  double edge_px = 0;
  return static_cast<float>(LitPatch(lit_, sight.hit, place, footprint).radiance(place, 1.0 / kSub, edge_px));
}

void RoomView::sample(int x, int y, PixelSamples& samples) const {
  PixelRays rays;
  samples.fill(0);
  if (!rays_of(x, y, rays)) return;
  const Sight sight = look(lit_.scene(), T_room_cam_.t, rays);
  const Hit& hit = sight.hit;
  if (hit.plane == nullptr) return;
  double edge_px = 0;
  const Vec2 middle = place_of(sight, hit.distance, sight.rays.direction);
  const Tangent tangent = tangent_at(*hit.plane, middle);
  const Mat22 footprint = footprint_on(*hit.plane, tangent.normal_room, sight.rays, hit.distance);
  const LitPatch patch(lit_, hit, middle, footprint);
  const double value = is_opening(sight) ? 0 : patch.radiance(middle, 1, edge_px);
  const bool outline = has_outline(sight) || has_rim(rays, sight);
  if (!outline && is_opening(sight)) return;
  if (edge_px > kEdgeReach_px && !outline) {
    samples.fill(static_cast<float>(value));
    return;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double dx = sub_offset_px(static_cast<int>(i % kSub)), dy = sub_offset_px(static_cast<int>(i / kSub));
    if (outline) {
      samples[i] = sample_alone(rays.at(dx, dy), footprint);
      continue;
    }
    const Vec3 ray = sight.rays.at(dx, dy);
    const Vec2 place = place_of(sight, tangent.distance(sight.eye_room, ray), ray);
    samples[i] = static_cast<float>(patch.radiance(place, 1.0 / kSub, edge_px));
  }
}

double RoomView::paper_radiance_quantile(double share) const {
  const camera::Intrinsics& lens = camera_.intrinsics();
  constexpr int kSpots = 64;
  std::vector<double> levels;
  for (int j = 0; j < kSpots; ++j) {
    for (int i = 0; i < kSpots; ++i) {
      PixelRays rays;
      if (!rays_of((i + 0.5) / kSpots * lens.width_px, (j + 0.5) / kSpots * lens.height_px, rays)) continue;
      const Hit hit = cast_ray(lit_.scene(), T_room_cam_.t, rays.direction);
      if (hit.plane == nullptr) continue;
      const Vec2 q = hit.plane->coordinates(T_room_cam_.t + hit.distance * rays.direction);
      if (const double level = lit_.paper_radiance(hit, q); level > 0) levels.push_back(level);
    }
  }
  if (levels.empty()) return 1;
  const auto middle = levels.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(levels.size() - 1));
  std::nth_element(levels.begin(), middle, levels.end());
  return *middle;
}

}  // namespace roomcal::tools
