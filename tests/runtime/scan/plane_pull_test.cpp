#include "runtime/scan/plane_pull.h"

#include <memory>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "runtime/map/plane_error.h"
#include "tests/runtime/scan/baked_room.h"
#include "tests/truth/random.h"
#include "tools/simulate/lidar_sweep.h"
#include "tools/simulate/make_room.h"

namespace roomcal::scan {
namespace {

const SE3 kT_room_lidar{so3_exp(Vec3(0.35, -0.2, 0.7)), Vec3(1.2, 1.7, 1.1)};

/// A surface of the same outlines whose planes are off: true = surface + delta.
class ShiftedSurface {
 public:
  ShiftedSurface(const Surface& exact, std::size_t face, const Vec3& delta) {
    std::vector<std::vector<Vec3>> outlines;
    for (std::size_t i = 0; i < exact.faces().size(); ++i) {
      const Face& from = exact.faces()[i];
      const auto vertices = exact.vertices_room(from);
      outlines.emplace_back(vertices.begin(), vertices.end());
      if (i != face) continue;
      // Signed distances of the surface are smaller by lever . delta than the true ones: it lies that much farther out.
      for (Vec3& p : outlines.back()) p += map::plane_lever(from.normal_room, p).dot(delta) * from.normal_room;
    }
    std::vector<Polygon> polygons;
    for (const auto& outline : outlines) polygons.push_back({outline});
    bytes_.resize(Surface::bytes(polygons.size(), 0));
    Arena arena{bytes_};
    surface = Surface::from_polygons(polygons, {}, arena).value();
  }
  Surface surface;

 private:
  std::vector<std::byte> bytes_;
};

class PlanePull : public testing::Test {
 protected:
  PlanePull() : room_(tools::make_room({.seed = 5})), scratch_bytes_(1U << 20U), scratch_(scratch_bytes_) {
    tools::SweepSimulator simulator(room_.scene);
    tools::SweepFlaws flaws;
    flaws.sigma_m = 0.005;
    sweep_ = simulator.sweep(tools::vlp16_beams(), flaws, kT_room_lidar, 3);
    view_ = sweep_.view();
    prior_.T_room_lidar = kT_room_lidar;
    prior_.cov = 1e-2 * Mat66::Identity();
  }

  SE3 locate_in(const Surface& surface, Location& location) {
    LocateOptions options;
    options.use_reflectivity = false;
    const Status status = locate(surface, {&view_, 1}, sensor_, &prior_, options, scratch_, location);
    EXPECT_TRUE(status.ok()) << status.detail();
    EXPECT_EQ(location.outcome, LocateOutcome::kLocated) << location.reason;
    return location.T_room_lidar;
  }

  test::BakedRoom room_;
  std::vector<std::byte> scratch_bytes_;
  Arena scratch_;
  tools::SimulatedSweep sweep_;
  lidar::Sweep view_;
  SensorModel sensor_{0.005, 0.010, 0.0003, 0.3, 100};
  PosePrior prior_;
};

TEST_F(PlanePull, PlaneThatIsOff_MovesTheEstimateByInformationInverseTimesPull) {
  const auto location = std::make_unique<Location>(), moved = std::make_unique<Location>();
  const Surface& exact = room_.surface;
  const SE3 T_exact = locate_in(exact, *location);
  FacePulls pulls;
  ASSERT_TRUE(find_face_pulls(exact, {&view_, 1}, sensor_, *location, scratch_, pulls).ok());
  ASSERT_EQ(pulls.size(), exact.faces().size());
  const Eigen::LDLT<Mat66> solver(location->information.information);
  for (const FacePull& pull : pulls) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 delta = (k == 0 ? 0.002 : 0.001) * Vec3::Unit(k);
      const ShiftedSurface off(exact, pull.face, delta);
      const Vec6 seen = se3_log(T_exact.inverse() * locate_in(off.surface, *moved));
      const Vec6 predicted = solver.solve(pull.pull * delta);
      EXPECT_LT((seen - predicted).norm(), 0.08 * predicted.norm() + 2e-5)
          << "face " << pull.face << " component " << k << "\nseen " << seen.transpose() << "\npredicted "
          << predicted.transpose();
    }
  }
}

TEST_F(PlanePull, ArenaThatIsTooSmall_IsRefused) {
  const auto location = std::make_unique<Location>();
  static_cast<void>(locate_in(room_.surface, *location));
  std::vector<std::byte> bytes(1000);
  Arena scratch{bytes};
  FacePulls pulls;
  EXPECT_EQ(find_face_pulls(room_.surface, {&view_, 1}, sensor_, *location, scratch, pulls).code(),
            StatusCode::kOutOfMemory);
  std::vector<std::byte> enough(face_pull_scratch_bytes());
  Arena whole{enough};
  EXPECT_TRUE(find_face_pulls(room_.surface, {&view_, 1}, sensor_, *location, whole, pulls).ok());
}

}  // namespace
}  // namespace roomcal::scan
