#include "libcommon/testing/rooms/known_rooms.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/testing/rooms/known_kinds.h"

namespace tdpt::testing {
namespace {

// Rooms of equal height and depth in a row along x. Draws all random numbers in a fixed order.
class Row {
 public:
  Row(RoomKind kind, uint64_t seed) : kind_(kind), site_(kind, seed) {}

  KnownRoom build() {
    choose_sizes();
    choose_openings();
    shell_and_walls();
    if (is(RoomKind::ajar) || is(RoomKind::ajar_full)) leaf();
    site_.lamps(space(lamp_room_), lamp_room_ > 0);
    for (size_t r = 0; r < lengths_.size(); ++r) site_.furniture(space(r));
    site_.camera(space(camera_room_));
    return site_.finish();
  }

 private:
  bool is(RoomKind kind) const { return kind_ == kind; }
  double between(double low, double high) { return site_.between(low, high); }
  Space space(size_t room) const {
    return {start(room), end(room), 0, height_, -0.5 * depth_, 0.5 * depth_};
  }
  Wall wall(size_t room) const { return wall_between(space(room), space(room + 1)); }
  double start(size_t room) const { return starts_[room]; }
  double end(size_t room) const { return starts_[room] + lengths_[room]; }

  void choose_sizes() {
    const bool row =
        is(RoomKind::holes_in_row) || is(RoomKind::doors_in_row) || is(RoomKind::closet);
    const size_t rooms = is(RoomKind::open_room) ? 1 : row ? 3 : 2;
    lamp_room_ = rooms - 1;
    // The closet is behind the camera's room or behind the lamp's.
    if (is(RoomKind::closet)) site_.chance(0.5) ? ++camera_room_ : --lamp_room_;
    double x = 0;
    for (size_t r = 0; r < rooms; ++r) {
      lengths_.push_back(between(2, 4));
      starts_.push_back(x);
      // Log-uniform thickness.
      thickness_.push_back(site_.log_between(0.01, 0.3));
      x += lengths_.back() + thickness_.back();
    }
    height_ = between(2.2, 2.8);
    depth_ = between(2, 4);
    if (is(RoomKind::window)) depth_ = between(3, 4.5);
    if (is(RoomKind::wide_window)) depth_ = between(2, 2.5);
    if (is(RoomKind::keyhole)) depth_ = 4;
  }

  // `aside`: space for a leaf to open into, so that it does not narrow the light's way beside it.
  WallOpening somewhere(double height, double width, double sill, double aside = 0.1) {
    const double s = between(0.1, depth_ - aside - width);
    return {sill, sill + height, s, s + width};
  }

  WallOpening opening() {
    switch (kind_) {
      case RoomKind::slit:
        return somewhere(between(1.2, 2), 0.03, between(0.05, 0.15));
      case RoomKind::floor_door:
      case RoomKind::through_floor:
      case RoomKind::doors_in_row: {
        const double width = between(0.6, 0.9);
        return somewhere(between(1.8, 2), width, 0);
      }
      case RoomKind::ajar:
      case RoomKind::ajar_full: {
        const double width = between(0.6, 0.9);
        return somewhere(is(RoomKind::ajar) ? between(1.8, 2) : height_, width, 0, 0.6);
      }
      case RoomKind::window: {
        const double width = between(0.6, 1.1);
        return somewhere(between(0.6, 1.1), width, between(0.7, 0.9));
      }
      case RoomKind::wide_window:
        return somewhere(between(1.5, 1.8), depth_ - 0.3, 0.3);
      case RoomKind::closet:
        if (openings_.size() == camera_room_) break;  // the hole through which the light passes
        {
          const double width = between(0.3, 0.8);
          return somewhere(between(0.3, 1.8), width, 0);
        }
      case RoomKind::keyhole:
        return somewhere(0.01, 0.01, between(0.8, 1.2));
      default:
        break;
    }
    // A hole with log-uniform size.
    const double side =
        (is(RoomKind::hole) ? 0.05 : 0.15) * std::pow(is(RoomKind::hole) ? 12 : 3, between(0, 1));
    return somewhere(side, side, between(0.3, height_ - side - 0.2));
  }

  void add(KnownAperture aperture) {
    aperture.optional = is(RoomKind::wide_window);
    site_.opening(std::move(aperture));
  }

  void choose_openings() {
    for (size_t w = 0; w + 1 < lengths_.size(); ++w) {
      std::vector<WallOpening> openings{opening()};
      while (is(RoomKind::two_openings) && openings.size() < 2) {
        const WallOpening o = opening(), &first = openings[0];
        constexpr double kGap = 0.2;
        if (o.z0 > first.z1 + kGap || o.z1 < first.z0 - kGap || o.y0 > first.y1 + kGap ||
            o.y1 < first.y0 - kGap)
          openings.push_back(o);
      }
      const bool on_the_way = camera_room_ <= w && w < lamp_room_;
      if (on_the_way && !is(RoomKind::ajar) && !is(RoomKind::ajar_full))
        for (const WallOpening& o : openings) add(aperture(wall(w), o));
      openings_.push_back(std::move(openings));
    }
  }

  void shell_and_walls() {
    const size_t last = lengths_.size() - 1;
    const bool through = is(RoomKind::through_floor);
    if (through) {
      const Space all{start(0), end(last), 0, height_, -0.5 * depth_, 0.5 * depth_};
      site_.part("floor", shell(all, kX0 | kX1 | kZ0 | kZ1 | kCeiling));
    }
    for (size_t r = 0; r <= last; ++r)
      site_.part("shell", shell(space(r), (r > 0 ? kX0 : 0u) | (r < last ? kX1 : 0u) |
                                              (through ? kFloor : 0u)));
    for (size_t w = 0; w < last; ++w) site_.part("wall", pierced(wall(w), openings_[w], !through));
  }

  // A leaf hinged on one side of the wall, a centimetre wider than the opening on both sides; its
  // inner face touches the wall along the hinge, so no light passes there.
  void leaf() {
    constexpr double kOverlap = 0.01, kThick = 0.03;
    WallOpening o = openings_[0][0];
    o.z0 -= 0.5 * depth_, o.z1 -= 0.5 * depth_;
    const bool full = is(RoomKind::ajar_full), to_camera = site_.chance(0.5);
    const double angle = between(5, 15) * kDegree;
    const double x = to_camera ? end(0) : start(1), out = to_camera ? -1 : 1;
    const double top = full ? height_ + 0.005 : o.y1 + kOverlap, bottom = full ? -0.005 : 0;
    const Vec3d hinge{x, 0, o.z0 - kOverlap};
    const Vec3d low{to_camera ? x - kThick : x, bottom, hinge.z},
        high{to_camera ? x : x + kThick, top, o.z1 + kOverlap};
    site_.part("leaf", box(low, high, out * angle, hinge));

    // The slit is between the jamb and the nearest point of the leaf.
    const Vec3d along{out * std::sin(angle), 0, std::cos(angle)};
    const double reach = (o.z1 - hinge.z) * std::cos(angle);
    const Vec3d foot = hinge + along * reach, jamb{x, 0, o.z1};
    const Vec3d up{0, full ? height_ : o.y1, 0};
    const Vec3d edge = hinge + along * (o.z1 + kOverlap - hinge.z);  // of the leaf
    add({{jamb, foot, foot + up, jamb + up}, along * -out, 0, {jamb, edge, edge + up, jamb + up}});
    if (full) return;
    const Vec3d over{0, kOverlap, 0};
    std::vector<Vec3d> gap{hinge + up, jamb + up, foot + up + over};
    const Vec3d n = normalize(cross(gap[1] - gap[0], gap[2] - gap[0]));
    // The leaf's top is as wide as the leaf is thick: light passes over both edges.
    const Vec3d back = Vec3d{out * std::cos(angle), 0, -std::sin(angle)} * kThick;
    const std::vector<Vec3d> far{hinge + up, jamb + up, foot + up + over + back,
                                 hinge + up + over + back};
    add({gap, (n.y > 0) == to_camera ? n : -n, 0, far});
  }

  RoomKind kind_;
  Site site_;
  std::vector<double> lengths_, starts_, thickness_;  // of rooms; of the wall behind each room
  size_t camera_room_ = 0, lamp_room_ = 0;
  double height_ = 0, depth_ = 0;
  std::vector<std::vector<WallOpening>> openings_;  // per wall
};

// In the order of RoomKind. Kinds without a builder are rows.
struct {
  const char* name;
  void (*build)(Site&);
} constexpr kKinds[] = {{"hole", nullptr},
                        {"slit", nullptr},
                        {"floor-door", nullptr},
                        {"through-floor", nullptr},
                        {"ajar-full", nullptr},
                        {"ajar", nullptr},
                        {"window", nullptr},
                        {"two-openings", nullptr},
                        {"holes-in-row", nullptr},
                        {"doors-in-row", nullptr},
                        {"closet", nullptr},
                        {"keyhole", nullptr},
                        {"wide-window", nullptr},
                        {"open-room", nullptr},
                        {"arch", arch},
                        {"banister", banister},
                        {"glazing-bars", glazing_bars},
                        {"blinds", blinds},
                        {"curtains", curtains},
                        {"bay", bay},
                        {"windows-in-row", windows_in_row},
                        {"double-door", double_door},
                        {"furnished-door", furnished_door},
                        {"l-room", l_room},
                        {"alcove", alcove},
                        {"shared-edge", shared_edge},
                        {"lampshade", lampshade},
                        {"lamp-outside", lamp_outside},
                        {"sky-window", sky_window},
                        {"sky-windows", sky_windows},
                        {"corner-windows", corner_windows},
                        {"skylight", skylight},
                        {"sky-blinds", sky_blinds},
                        {"colonnade", colonnade},
                        {"room-behind", room_behind},
                        {"deep-facade", deep_facade},
                        {"landscape", landscape},
                        {"deep-room", deep_room}};

std::vector<RoomKind> kinds_between(size_t first, size_t last) {
  std::vector<RoomKind> kinds;
  for (size_t k = first; k < last; ++k) kinds.push_back(static_cast<RoomKind>(k));
  return kinds;
}
constexpr auto kFirstSky = static_cast<size_t>(RoomKind::sky_window);

}  // namespace

const char* name_of(RoomKind kind) {
  return kKinds[static_cast<size_t>(kind)].name;
}

const std::vector<RoomKind>& all_room_kinds() {
  static const std::vector<RoomKind> kinds = kinds_between(0, kFirstSky);
  return kinds;
}

const std::vector<RoomKind>& sky_room_kinds() {
  static const std::vector<RoomKind> kinds = kinds_between(kFirstSky, std::size(kKinds));
  return kinds;
}

std::vector<KnownAperture> KnownRoom::placed_apertures() const {
  std::vector<KnownAperture> placed;
  for (const KnownAperture& a : apertures) placed.push_back(writing.placement(a));
  return placed;
}

std::string KnownRoom::file() const {
  return std::string(name_of(kind)) + "-" + std::to_string(seed) + ".glb";
}

KnownRoom known_room(RoomKind kind, uint64_t seed) {
  const auto build = kKinds[static_cast<size_t>(kind)].build;
  if (build == nullptr) return Row(kind, seed).build();
  Site site(kind, seed);
  build(site);
  return site.finish();
}

}  // namespace tdpt::testing
