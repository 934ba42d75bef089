#include "tools/simulate/make_room.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/random.h"
#include "tools/simulate/furniture.h"
#include "tools/simulate/paster.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/room_walls.h"

namespace roomcal::tools {

namespace {

constexpr double kPillarAlbedo = 0.45;
constexpr double kPanelBelowCeiling_m = 0.005;

void build_pillar(const RoomOptions& options, Random& random, Scene& scene) {
  const Vec3& size = options.size;
  const Vec3 half(random.uniform(0.15, 0.2), random.uniform(0.15, 0.2), size.z());
  const Vec3 centre(size.x() - half.x() + 0.02, size.y() * random.uniform(0.35, 0.65), size.z() / 2);
  scene.bodies.push_back(make_box("pillar", centre, half, deg_to_rad(random.uniform(-2, 2)), kPillarAlbedo));
}

void build_boxes(const RoomOptions& options, Random& random, Scene& scene) {
  for (int i = 0; i < options.boxes; ++i) {
    const Vec3 half(random.uniform(0.03, 0.12), random.uniform(0.03, 0.12), random.uniform(0.2, 0.6));
    Vec3 centre(options.size.x() * random.uniform(0.15, 0.85), options.size.y() * random.uniform(0.15, 0.85), half.z());
    if (scene.bounded()) centre = draw_free_place(scene, half.z(), 0.13, random);
    scene.bodies.push_back(
        make_box(fmt::format("box{}", i), centre, half, random.uniform(0, kPi), random.uniform(0.1, 0.7)));
  }
}

void hang_lamps(Random& random, Scene& scene) {
  const Vec3& size = scene.size;
  for (const double depth : {0.28, 0.74}) {
    Lamp panel;
    panel.half_size = Vec2(0.15, 0.45);
    panel.centre = Vec3(size.x() * random.uniform(0.3, 0.7), size.y() * (depth + random.uniform(-0.05, 0.05)),
                        size.z() - kPanelBelowCeiling_m);
    panel.intensity = random.uniform(0.8, 1.6);
    scene.lamps.push_back(panel);
  }
  Lamp bulb;  // near a wall: steep light on the sheets beside it, hard shadows behind things
  bulb.all_around = true;
  bulb.centre = Vec3(size.x() * random.uniform(0.1, 0.25), size.y() * random.uniform(0.2, 0.8),
                     size.z() * random.uniform(0.6, 0.8));
  bulb.intensity = random.uniform(0.08, 0.16);
  scene.lamps.push_back(bulb);
}

/// A panel for every six square metres of the box around the room, and a bulb near something.
void hang_lamps_freely(Random& random, Scene& scene) {
  constexpr double kAreaPerPanel_m2 = 6, kBelowCeiling_m = 0.2;
  const int panels = std::clamp(static_cast<int>(scene.size.x() * scene.size.y() / kAreaPerPanel_m2), 2, 8);
  for (int i = 0; i < panels; ++i) {
    Lamp panel;
    panel.half_size = Vec2(0.15, 0.45);
    panel.centre = draw_free_place(scene, scene.size.z() - kBelowCeiling_m, kBelowCeiling_m / 2, random);
    panel.centre.z() = scene.low.z() + scene.size.z() - kPanelBelowCeiling_m;
    panel.intensity = random.uniform(0.8, 1.6);
    scene.lamps.push_back(panel);
  }
  Lamp bulb;
  bulb.all_around = true;
  bulb.centre = draw_free_place(scene, 0.7 * scene.size.z(), 0.25, random);
  bulb.intensity = random.uniform(0.08, 0.16);
  scene.lamps.push_back(bulb);
}

void paste_markers(const RoomOptions& options, Paster& paster) {
  Decal sheet;
  sheet.print = Print::kRings;
  sheet.half_size = Vec2(kSheetWidth_m, kSheetHeight_m) / 2;
  sheet.radius_m = kMarkerRadius_m;
  for (int id = 0; id < options.markers; ++id) {
    sheet.marker_id = id;
    if (paster.paste(sheet)) continue;
    throw ToolError(fmt::format("--markers {}: only {} sheets fit onto the walls; take fewer or a larger room",
                                options.markers, id));
  }
}

void paste_distractors(const RoomOptions& options, Random& random, Paster& paster) {
  for (int i = 0; i < options.distractors; ++i) {
    Decal decal;
    decal.print = static_cast<Print>(1 + i % 5);
    decal.radius_m = random.uniform(0.03, 0.07);
    decal.half_size = Vec2(1.25, 1.25) * decal.radius_m;
    if (!paster.paste(decal)) return;  // a full wall needs no more of them
  }
}

void check(const RoomOptions& options) {
  if (!options.walls.empty()) {
    if (options.pillar) throw ToolError("--pillar: draw it into --walls, as four walls around it");
  } else if (!(options.size.minCoeff() >= 1 && options.size.maxCoeff() <= 50)) {
    throw ToolError("--size: width, depth and height must be 1 to 50 m, as in 3x4x2.7");
  }
}

}  // namespace

Scene make_room(const RoomOptions& options) {
  check(options);
  Scene scene;
  scene.seed = options.seed;
  scene.ambient = 0.06;
  Random random(options.seed);
  std::vector<KeepOut> keep_out;
  if (options.walls.empty()) {
    build_box(options.size, random, scene);
    if (options.pillar) build_pillar(options, random, scene);
    build_boxes(options, random, scene);
    hang_lamps(random, scene);
  } else {
    build_drawn_walls(options.walls, scene);
    build_boxes(options, random, scene);
    hang_lamps_freely(random, scene);
    for (const Wall& wall : options.walls) keep_out.push_back(wall.keep_out_m);
  }
  Paster paster(scene, random, std::move(keep_out));
  paste_markers(options, paster);
  paste_distractors(options, random, paster);
  Random later = random_stream(options.seed, 1);  // what came later may not change older rooms
  add_waves(options.waviness_m, later, scene);
  add_furniture(options.furniture, later, scene);
  return scene;
}

}  // namespace roomcal::tools
