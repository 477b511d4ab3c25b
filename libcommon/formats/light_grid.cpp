// Light grids as OpenVDB files. Grid transforms place voxel centres in metres, so viewers show the
// light in the right place; a header in the file's metadata has the box of the dense arrays.
#include "libcommon/formats/light_grid.h"

#include <new>
#include <optional>
#include <set>
#include <sstream>
#include <type_traits>

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointCount.h>
#include <openvdb/tools/Dense.h>
#include <tbb/global_control.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/light_grid_header.h"

namespace tdpt {
namespace {

namespace vdb = openvdb;
using PointGrid = vdb::points::PointDataGrid;

void initialise() {
  static const bool once = (vdb::initialize(), true);
  (void)once;
}

vdb::CoordBBox box_of(const LightGrid& grid) {
  return {vdb::Coord(0), vdb::Coord(grid.dim[0] - 1, grid.dim[1] - 1, grid.dim[2] - 1)};
}

// OpenVDB refuses voxels with a volume below 3e-15: its transforms show smaller ones enlarged by
// this power of two.
double unit_of(const LightGrid& grid) {
  constexpr double kSmallest = 2e-5;
  return grid.voxel > 0 && grid.voxel < kSmallest
             ? std::exp2(std::ceil(std::log2(kSmallest / grid.voxel)))
             : 1;
}

vdb::math::Transform::Ptr transform_of(const LightGrid& grid) {
  const double unit = unit_of(grid);
  auto t = vdb::math::Transform::createLinearTransform(grid.voxel * unit);
  const Vec3d centre = (grid.origin + Vec3d(0.5 * grid.voxel)) * unit;
  t->postTranslate({centre.x, centre.y, centre.z});
  return t;
}

// Rotates +Y up to +Z up, row vector times matrix: (x, y, z) -> (x, -z, y).
const vdb::Mat4d kUpright(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);
const vdb::Mat4d kLying = kUpright.transpose();

// Rotates a grid for viewers whose up is +Z: positions by the transform, vectors by their values.
template <class GridPtr>
void place_upright(const GridPtr& grid) {
  const auto transform = grid->transform().copy();
  transform->postMult(kUpright);
  grid->setTransform(transform);
}

Vec3f upright(const Vec3f& v) {
  return {v.x, -v.z, v.y};
}

vdb::Vec3d of_file(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

// Dense x-fastest array -> sparse grid without background voxels.
template <class Grid, class Value>
typename Grid::Ptr sparse(const LightGrid& light, const char* name,
                          const std::vector<Value>& values) {
  using Element = typename Grid::ValueType;
  auto grid = Grid::create();
  grid->setName(name);
  grid->setTransform(transform_of(light));
  auto access = grid->getAccessor();
  size_t at = 0;
  for (int k = 0; k < light.dim[2]; ++k)
    for (int j = 0; j < light.dim[1]; ++j)
      for (int i = 0; i < light.dim[0]; ++i, ++at) {
        const Value& v = values[at];
        if constexpr (std::is_same_v<Value, Vec3f>) {
          if (v != Vec3f{}) access.setValueOn({i, j, k}, Element(v.x, v.y, v.z));
        } else {
          if (v != Value{}) access.setValueOn({i, j, k}, static_cast<Element>(v));
        }
      }
  grid->pruneGrid();
  return grid;
}

struct Positions {
  using PosType = vdb::Vec3R;
  using value_type = vdb::Vec3R;
  const std::vector<LightLine>& lines;
  double unit;
  size_t size() const { return lines.size(); }
  void getPos(size_t n, vdb::Vec3R& p) const { p = of_file(lines[n].light * unit); }
};

template <class Value>
void append(PointGrid& grid, const vdb::tools::PointIndexGrid& index, const char* name,
            const std::vector<Value>& values) {
  vdb::points::appendAttribute<Value>(grid.tree(), name);
  vdb::points::PointAttributeVector<Value> wrapper(values);
  vdb::points::populateAttribute(grid.tree(), index.tree(), name, wrapper);
}

// `joins`: per line, or null for those of light.lines.
PointGrid::Ptr points_of(const LightGrid& light, const char* name,
                         const std::vector<LightLine>& lines, const std::vector<int32_t>* joins,
                         bool z_up) {
  const auto transform = transform_of(light);
  const Positions positions{lines, unit_of(light)};
  const auto index =
      vdb::tools::createPointIndexGrid<vdb::tools::PointIndexGrid>(positions, *transform);
  auto grid = vdb::points::createPointDataGrid<vdb::points::NullCodec, PointGrid>(*index, positions,
                                                                                  *transform);
  grid->setName(name);
  std::vector<vdb::Vec3f> along;
  std::vector<int32_t> cut;
  std::vector<float> share;
  for (const LightLine& l : lines) {
    Vec3f d(l.camera - l.light);
    if (z_up) d = upright(d);
    along.emplace_back(d.x, d.y, d.z);
    cut.push_back(static_cast<int32_t>(l.cut));
    share.push_back(static_cast<float>(l.share));
  }
  append(*grid, *index, "along", along);
  append(*grid, *index, "cut", cut);
  if (!joins) append(*grid, *index, "share", share);
  if (joins) append(*grid, *index, "joins", *joins);
  return grid;
}

// The file's identifier, random in OpenVDB's own files, is a hash of its other bytes: the same
// light gives the same bytes, and damage is detected. It follows the magic number (8), versions
// (12) and one flag; the digits for an identifier's version (RFC 9562) mark it as such a hash.
constexpr size_t kIdentifierAt = 21, kIdentifierLength = 36;

std::string identifier_of(std::string bytes) {
  bytes.replace(kIdentifierAt, kIdentifierLength, kIdentifierLength, '0');
  std::string id = content_hash(bytes);
  for (const size_t dash : {8, 13, 18, 23}) id.insert(dash, "-");
  id[14] = '8', id[19] = 'a';
  return id;
}

// Whether the identifier is marked as a hash but does not match. Files of other programs have other
// kinds of identifiers.
bool is_damaged(const std::string& bytes) {
  if (bytes.size() < kIdentifierAt + kIdentifierLength) return false;
  const std::string id = bytes.substr(kIdentifierAt, kIdentifierLength);
  return id[14] == '8' && id[19] == 'a' && id != identifier_of(bytes);
}

constexpr const char *kHeader = "tdpt_light_grid", *kZUp = "tdpt_z_up";
constexpr vdb::Index64 kLinesForNothing = 1 << 16;

class GridReader {
 public:
  explicit GridReader(std::string name) : name_(std::move(name)) {}

  LightGrid read(const std::string& bytes) {
    LightGrid light;
    light.hash = content_hash(bytes);
    most_lines_ = kLinesForNothing + bytes.size();
    std::istringstream in(bytes, std::ios::binary);
    in.exceptions(std::ios::failbit | std::ios::badbit);  // OpenVDB does not check for the end
    vdb::io::Stream stream(in, /*delayLoad=*/false);
    read_metadata(*stream.getMetadata(), light);
    const vdb::GridPtrVecPtr grids = stream.getGrids();
    check_size(*grids);
    // A grid without voxels need not be read.
    const size_t n = voxels_;
    light.count.assign(n, 0);
    light.air.assign(n, 0);
    light.direction.assign(n, {});
    std::set<std::string> seen;
    for (const auto& base : *grids) {
      if (!base) continue;
      const std::string& grid = base->getName();
      if (!seen.insert(grid).second) fail("grid " + shown(grid, 40), "again, expected each once");
      if (grid == "count") dense(cast<vdb::FloatGrid>(base), light, light.count);
      if (grid == "direction") dense(cast<vdb::Vec3SGrid>(base), light, light.direction);
      if (grid == "air") dense(cast<vdb::MaskGrid>(base), light, light.air);
      if (grid == "lines")
        lines(cast<PointGrid>(base), light, grid,
              [&](const LightLine& line, bool) { light.lines.push_back(line); });
      if (grid == "probes")
        lines(cast<PointGrid>(base), light, grid, [&](const LightLine& line, bool joins) {
          light.probes.push_back({line, joins});
        });
    }
    if (light.bottleneck) expect_all(seen);
    return light;
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    throw InputError(name_, place, what);
  }

  // Programs that know no points or masks save the others alone.
  void expect_all(const std::set<std::string>& seen) const {
    std::vector<std::string> missing;
    for (const char* grid : {"count", "air", "direction", "lines"})
      if (!seen.contains(grid)) missing.emplace_back(grid);
    if (!missing.empty())
      fail("", fmt::format("has no grid {}, expected count, air, direction and lines: did another "
                           "program save it again?",
                           fmt::join(missing, ", ")));
  }

  // A vector of the file in the scene's axes.
  Vec3f of_scene(const vdb::Vec3f& v) const {
    return z_up_ ? Vec3f(v.x(), v.z(), -v.y()) : Vec3f(v.x(), v.y(), v.z());
  }

  void read_metadata(const vdb::MetaMap& meta, LightGrid& light) {
    const auto text = meta.getMetadata<vdb::StringMetadata>(kHeader);
    if (!text) fail(kHeader, "is missing, expected a light grid as lightgrid writes it");
    TextLines in(text->value(), name_ + ":" + kHeader);
    LightGridHeader header;
    if (read_header(in, header).more) in.fail("a row, expected lines that begin with '#'");
    if (!header.has_box) in.fail_file("no '# grid' line, expected the box of the voxels");
    header.grid.hash = std::move(light.hash);
    light = std::move(header.grid);
    voxels_ = 1;
    for (const int side : light.dim) voxels_ *= static_cast<size_t>(side);
    z_up_ = static_cast<bool>(meta[kZUp]);
  }

  // Bounds the box by the number of stored voxels: a few bytes must not allocate much memory.
  void check_size(const vdb::GridPtrVec& grids) const {
    constexpr size_t kForNothing = size_t{1} << 20, kForEachActive = 1024;
    vdb::Index64 active = 0;
    for (const auto& grid : grids)
      if (grid && (grid->getName() == "count" || grid->getName() == "air"))
        active = std::max(active, grid->activeVoxelCount());
    if (voxels_ > kForNothing && (voxels_ - kForNothing) / kForEachActive > active)
      fail(kHeader, fmt::format("{} voxels, but {} hold air or light, expected one in {}", voxels_,
                                active, kForEachActive));
    expect_memory(name_, kHeader, fmt::format("{} voxels", voxels_),
                  voxels_ * (sizeof(float) + sizeof(uint8_t) + sizeof(Vec3f)));
  }

  template <class Grid>
  typename Grid::Ptr cast(const vdb::GridBase::Ptr& base) const {
    const auto typed = vdb::gridPtrCast<Grid>(base);
    if (!typed)
      fail("grid " + base->getName(),
           fmt::format("has the type {}, expected {}", shown(base->type()), Grid::gridType()));
    return typed;
  }

  template <class GridPtr, class Value>
  void dense(const GridPtr& grid, const LightGrid& light, std::vector<Value>& values) const {
    values.assign(voxels_, Value{});
    const vdb::CoordBBox box = box_of(light);
    const std::string place = "grid " + grid->getName();
    for (auto it = grid->cbeginValueOn(); it; ++it) {
      vdb::CoordBBox part = it.getBoundingBox();
      if (!box.isInside(part)) fail(place, "reaches out of its box");
      Value v{};
      if constexpr (std::is_same_v<Value, Vec3f>) {
        v = of_scene(*it);
        if (!is_finite(v)) fail(place, "holds a value that is not finite");
      } else if constexpr (std::is_same_v<Value, float>) {
        v = *it;
        if (!std::isfinite(v) || v < 0) fail(place, fmt::format("holds {}, expected a count", v));
      } else {
        v = 1;
      }
      for (const vdb::Coord& c : part) values[light.index(c.x(), c.y(), c.z())] = v;
    }
  }

  // Calls add(line, joins) for each line; in a grid without that attribute all lines join, and
  // without shares they are 0.
  template <class Add>
  void lines(const PointGrid::Ptr& grid, const LightGrid& light, const std::string& name,
             const Add& add) const {
    const std::string at = "grid " + name;
    // A value that all points share is stored once, for any number of points; lines differ, so they
    // take space in the file.
    if (const vdb::Index64 n = vdb::points::pointCount(grid->tree()); n > most_lines_)
      fail(at, fmt::format("{} lines, expected at most {} in a file of this size", n, most_lines_));
    const auto transform = grid->transform().copy();
    if (z_up_) transform->postMult(kLying);
    const double unit = unit_of(light);
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
      const auto& attributes = leaf->attributeSet();
      for (const char* attribute : {"P", "along", "cut"})
        if (attributes.find(attribute) == vdb::points::AttributeSet::INVALID_POS)
          fail(at, "has no points with the attributes P, along and cut");
      vdb::points::AttributeHandle<vdb::Vec3f> place(leaf->constAttributeArray("P"));
      vdb::points::AttributeHandle<vdb::Vec3f> along(leaf->constAttributeArray("along"));
      vdb::points::AttributeHandle<int32_t> cut(leaf->constAttributeArray("cut"));
      std::optional<vdb::points::AttributeHandle<float>> share;
      if (attributes.find("share") != vdb::points::AttributeSet::INVALID_POS)
        share.emplace(leaf->constAttributeArray("share"));
      const bool has_joins = attributes.find("joins") != vdb::points::AttributeSet::INVALID_POS;
      vdb::points::AttributeHandle<int32_t> joins(
          leaf->constAttributeArray(has_joins ? "joins" : "cut"));
      for (auto it = leaf->beginIndexOn(); it; ++it) {
        if (*it >= place.size() || *it >= along.size() || *it >= cut.size() ||
            *it >= joins.size() || (share && *it >= share->size()))
          fail(at, "names a point that does not exist");
        const vdb::Vec3d p =
            transform->indexToWorld(vdb::Vec3d(place.get(*it)) + it.getCoord().asVec3d()) / unit;
        LightLine line{{p.x(), p.y(), p.z()}, {}, 0};
        line.camera = line.light + Vec3d(of_scene(along.get(*it)));
        check_ends(at, light, line);
        if (cut.get(*it) < 0 || cut.get(*it) >= static_cast<int32_t>(kMostCuts))
          fail(at, fmt::format("holds a line of cut {}, expected one of 0 to {}", cut.get(*it),
                               kMostCuts - 1));
        line.cut = static_cast<uint32_t>(cut.get(*it));
        if (share) line.share = double{share->get(*it)};
        if (!(line.share >= 0 && line.share <= kMostShare))
          fail(at, fmt::format("holds a line with the share {}, expected 0 to {}", line.share,
                               kMostShare));
        add(line, !has_joins || joins.get(*it) != 0);
      }
    }
  }

  void check_ends(const std::string& place, const LightGrid& light, const LightLine& line) const {
    if (!is_finite(line.light) || !is_finite(line.camera) || line.light == line.camera)
      fail(place, "holds a line that is no segment");
    for (const Vec3d& end : {line.light, line.camera})
      for (int c = 0; c < 3; ++c) {
        const double at = (end[c] - light.origin[c]) / light.voxel;
        const int side = light.dim[static_cast<size_t>(c)];
        if (!(side > 0 && at >= -1 && at <= side + 1)) fail(place, "reaches out of its box");
      }
  }

  std::string name_;
  size_t voxels_ = 0;
  vdb::Index64 most_lines_ = 0;
  bool z_up_ = false;
};

}  // namespace

LightGrid parse_light_grid(const std::string& bytes, const std::string& name) {
  initialise();
  const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
  if (is_damaged(bytes)) throw InputError(name, "", "is damaged or cut short");
  try {
    return GridReader(name).read(bytes);
  } catch (const InputError&) {
    throw;
  } catch (const std::ios_base::failure&) {
    throw InputError(name, "", "is no light grid in OpenVDB format, or is cut short");
  } catch (const std::bad_alloc&) {
    throw InputError(name, "",
                     "takes more memory than there is, or than the " + size_words(memory_limit()) +
                         " of --max-memory");
  } catch (const std::exception& e) {
    throw InputError(name, "",
                     fmt::format("is no light grid in OpenVDB format: {}", shown(e.what(), 300)));
  }
}

std::string light_grid_bytes(const LightGrid& light, bool z_up) {
  initialise();
  vdb::MetaMap meta;
  meta.insertMeta(kHeader, vdb::StringMetadata(header_of(light)));
  if (z_up) meta.insertMeta(kZUp, vdb::BoolMetadata(true));
  vdb::GridPtrVec grids;
  const auto count = sparse<vdb::FloatGrid>(light, "count", light.count);
  count->setGridClass(vdb::GRID_FOG_VOLUME);
  grids.push_back(count);
  grids.push_back(sparse<vdb::MaskGrid>(light, "air", light.air));
  std::vector<Vec3f> direction = light.direction;
  if (z_up) std::transform(direction.begin(), direction.end(), direction.begin(), upright);
  grids.push_back(sparse<vdb::Vec3SGrid>(light, "direction", direction));
  if (light.bottleneck) grids.push_back(points_of(light, "lines", light.lines, nullptr, z_up));
  if (!light.probes.empty()) {
    std::vector<LightLine> lines;
    std::vector<int32_t> joins;
    for (const Probe& probe : light.probes) {
      lines.push_back(probe.line);
      joins.push_back(probe.joins);
    }
    grids.push_back(points_of(light, "probes", lines, &joins, z_up));
  }
  if (z_up)
    for (const auto& each : grids) place_upright(each);
  std::ostringstream out(std::ios::binary);
  vdb::io::Stream(out).write(grids, meta);
  std::string bytes = out.str();
  bytes.replace(kIdentifierAt, kIdentifierLength, identifier_of(bytes));
  return bytes;
}

}  // namespace tdpt
