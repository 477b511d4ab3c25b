// Where the time of a program goes.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace tdpt {

/// Phases that follow each other from the start of the clock, by name; those of one name are
/// summed.
class Phases {
 public:
  struct Phase {
    std::string name;
    double seconds;      ///< on the wall
    double cpu_seconds;  ///< of all threads of the process
  };

  Phases();

  /// Ends the phase that began where the one before ended.
  void done(const std::string& name);

  /// In the order in which their names first came.
  const std::vector<Phase>& all() const { return phases_; }

 private:
  double wall_, cpu_;
  std::vector<Phase> phases_;
};

/// Largest memory the process has held so far [bytes].
int64_t peak_memory();

/// {"NAME": {"seconds": S, "cpu_seconds": C}, ...} for any of nlohmann's types.
template <class Json>
void to_json(Json& j, const Phases& phases) {
  j = Json::object();
  for (const Phases::Phase& p : phases.all()) {
    j[p.name]["seconds"] = p.seconds;
    j[p.name]["cpu_seconds"] = p.cpu_seconds;
  }
}

}  // namespace tdpt
