// Parses a Mitsuba scene: defaults and $names, includes, search paths, ids and references.
#pragma once
#include <deque>
#include <map>
#include <string>

#include "tools/tdpt-import/mitsuba/object.h"

namespace tdpt::foreign::mitsuba {

struct Document {
  std::deque<Object> objects;     ///< addresses stay
  const Object* scene = nullptr;  ///< its values are what the scene holds
};

/// Throws InputError for malformed files, unknown ids, and objects that hold themselves.
Document parse(Source& source, const std::map<std::string, std::string>& parameters);

}  // namespace tdpt::foreign::mitsuba
