// Where a program spends its time.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace tdpt {

/// Consecutive phases by name, from the start of the clock; phases of the same name are summed.
class Phases {
 public:
  struct Phase {
    std::string name;
    double seconds;      ///< on the wall
    double cpu_seconds;  ///< of all threads of the process
  };

  Phases();

  /// Ends the phase that began when the last one ended.
  void done(const std::string& name);

  /// In order of their first appearance.
  const std::vector<Phase>& all() const { return phases_; }

 private:
  double wall_, cpu_;
  std::vector<Phase> phases_;
};

/// Peak memory of the process so far [bytes].
int64_t peak_memory();

/// {"NAME": {"seconds": S, "cpu_seconds": C}, ...} for any of nlohmann's JSON types.
template <class Json>
void to_json(Json& j, const Phases& phases) {
  j = Json::object();
  for (const Phases::Phase& p : phases.all()) {
    j[p.name]["seconds"] = p.seconds;
    j[p.name]["cpu_seconds"] = p.cpu_seconds;
  }
}

}  // namespace tdpt
