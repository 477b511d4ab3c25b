// Thins out a list.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace tdpt {

/// Every k-th item, from the first one on, with the smallest k that leaves at most `most` > 0.
template <class T>
std::vector<T> thinned(const std::vector<T>& items, size_t most) {
  std::vector<T> some;
  const size_t k = std::max<size_t>(1, (items.size() + most - 1) / most);
  for (size_t i = 0; i < items.size(); i += k) some.push_back(items[i]);
  return some;
}

}  // namespace tdpt
