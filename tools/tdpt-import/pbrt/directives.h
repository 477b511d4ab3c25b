// The directives of pbrt's scene files.
#pragma once
#include <string>

namespace tdpt::foreign::pbrt {

class Builder;

struct Directive {
  const char* name;
  void (*run)(Builder&);
};

/// None if there is no such directive.
const Directive* directive_of(const std::string& name);

}  // namespace tdpt::foreign::pbrt
