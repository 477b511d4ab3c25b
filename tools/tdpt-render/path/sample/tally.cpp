#include "tools/tdpt-render/path/sample/tally.h"

#include <algorithm>

namespace tdpt {

void Tally::leave_out(const SamplePixel& place) {
  ++not_finite;
  not_finite_at.insert(std::upper_bound(not_finite_at.begin(), not_finite_at.end(), place), place);
  if (not_finite_at.size() > kMostPlaces) not_finite_at.pop_back();
}

void Tally::merge(const Tally& other) {
  rays.merge(other.rays);
  for (size_t i = 0; i < kTechniques; ++i) energy[i].merge(other.energy[i]);
  for (size_t i = 0; i < kOctaves; ++i) by_length[i].merge(other.by_length[i]);
  if (portals.size() < other.portals.size())
    portals.resize(other.portals.size(), {0, 0, UnitSum(unit_)});
  for (size_t i = 0; i < other.portals.size(); ++i) {
    portals[i].drawn += other.portals[i].drawn;
    portals[i].lit += other.portals[i].lit;
    portals[i].energy.merge(other.portals[i].energy);
  }
  not_finite += other.not_finite;
  not_finite_at.insert(not_finite_at.end(), other.not_finite_at.begin(), other.not_finite_at.end());
  std::sort(not_finite_at.begin(), not_finite_at.end());
  if (not_finite_at.size() > kMostPlaces) not_finite_at.resize(kMostPlaces);
}

}  // namespace tdpt
