#include "tools/tdpt-render/testing/scalar_build.h"

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/sequence.h"
#include "tools/tdpt-render/testing/scalar_kernels.h"

namespace tdpt {
namespace shader {
namespace {

struct Memory {
  const Capacity room;
  const uint words_of_film;
  static constexpr bool layered = true;
#define VECTOR(binding, type, name, array, count) \
  std::vector<type> array = std::vector<type>(count);
  PATH_TABLES(VECTOR)
  std::vector<uint> film_words = std::vector<uint>(words_of_film);
#undef VECTOR
};

}  // namespace
}  // namespace shader

namespace {

class ScalarMachine : public Machine {
 public:
  ScalarMachine(const RenderTables& tables, const Capacity& room, uint32_t film_words)
      : room_(room), kernels_(shader::kernels_of(tables)), memory_{room, film_words} {
#define REFER(binding, type, name, array, count) kernels_.array = memory_.array.data();
    PATH_TABLES(REFER)
    kernels_.film_words = memory_.film_words.data();
#undef REFER
  }

  Capacity room() const override {
    return room_;
  }

  void set(const shader::RenderParameters& p, const std::vector<uint32_t>& cache_offsets) override {
    std::copy(cache_offsets.begin(), cache_offsets.end(), kernels_.cache_offsets);
    kernels_.render = p;
    kernels_.camera_culls = p.culls != 0;
    kernels_.mixture_techniques = p.techniques;
    kernels_.power_heuristic = p.beta == 2;
    kernels_.film_has_layers = p.layers != 0;
    kernels_.film_has_halves = p.halves != 0;
    kernels_.film_is_transparent = p.transparent != 0;
    kernels_.guide_active = p.guide_light > 0 || p.guide_camera > 0;
  }

  void run(Step step, const shader::StepParameters& parameters) override {
    constexpr uint32_t kGroup = 64;
    kernels_.work = parameters;
    oneapi::tbb::parallel_for(
        uint32_t{0}, (parameters.count + kGroup - 1) / kGroup, [&](uint32_t group) {
          shader::ScalarKernels kernels = kernels_;
          kernels.bucket = group % shader::kTallyBuckets;
          const uint32_t end = std::min(parameters.count, (group + 1) * kGroup);
          for (uint32_t i = group * kGroup; i < end; ++i) kernels.run(step, i);
        });
  }

  uint32_t pick(uint32_t count, uint32_t first) override {
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; ++i) {
      kernels_.ranks[i] = n;
      if (kernels_.flags[i] != 0) kernels_.alive[n++] = first + i;
    }
    return n;
  }

  void place_ends(uint32_t walks) override {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < walks; ++i) {
      kernels_.end_first[i] = sum;
      sum += kernels_.walk_counts[i];
    }
    kernels_.end_first[walks] = sum;
  }

  std::vector<uint32_t> take_film() override {
    std::vector<uint32_t> words = memory_.film_words;
    std::fill(memory_.film_words.begin(), memory_.film_words.end(), 0u);
    return words;
  }

 private:
  const Capacity room_;
  shader::ScalarKernels kernels_;
  shader::Memory memory_;
};

}  // namespace

std::unique_ptr<Machine> make_scalar_machine(const RenderTables& tables, const Capacity& room,
                                             uint32_t film_words) {
  return std::make_unique<ScalarMachine>(tables, room, film_words);
}

}  // namespace tdpt
