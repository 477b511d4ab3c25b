// A device that is lost during rendering: nothing rendered before is lost, and the resumed picture
// is byte-identical to an uninterrupted one.
#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/device/wavefront.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/scalar_build.h"

namespace tdpt::lost_device_test {

// Is lost after a given number of steps.
class LostMachine : public Machine {
 public:
  LostMachine(std::unique_ptr<Machine> sound, int& steps)
      : sound_(std::move(sound)), left_(steps) {}
  Capacity room() const override { return sound_->room(); }
  void set(const shader::RenderParameters& p, const std::vector<uint32_t>& offsets) override {
    sound_->set(p, offsets);
  }
  void run(Step step, const shader::StepParameters& p) override {
    if (left_-- == 0) throw Error(Exit::no_device, "cannot run on a device: ErrorDeviceLost");
    sound_->run(step, p);
  }
  uint32_t pick(uint32_t count, uint32_t first) override { return sound_->pick(count, first); }
  void place_ends(uint32_t walks) override { sound_->place_ends(walks); }
  std::vector<uint32_t> take_film() override { return sound_->take_film(); }

 private:
  std::unique_ptr<Machine> sound_;
  int& left_;
};

class lost_device : public ::testing::Test {
 protected:
  // The machine fails at step number `steps`; -1: never.
  std::shared_ptr<SampleRenderer> lost_after(int steps) {
    left_ = steps;
    const FilmPlaces places(24 * 18, {.layers = true}, vista_.openings.portals.portals());
    return std::make_shared<WavefrontRenderer>(
        vista_,
        std::make_unique<LostMachine>(
            make_scalar_machine(tables_, {1u << 16, 1u << 10}, places.words), left_),
        "lost");
  }
  // `kept`: the film of what was rendered if the renderer fails. `film`: to go on from.
  static RenderResult rendered(const std::shared_ptr<SampleRenderer>& renderer,
                               std::string* kept = nullptr, const std::string& film = "") {
    Job job;
    job.named = tdpt_org;
    job.limits.spp = 9;
    job.max_depth = 6;
    job.layers = job.alpha = true;
    job.frames = true;  // one sample at a time
    Session session(*renderer, job);
    const std::vector<Candidate> candidates{{tdpt_org, tdpt_org.name}};
    const auto begun = [&] { return parse_film(film, "kept"); };
    const Plan plan = make_plan(session, candidates, {});
    const auto progress = std::make_shared<Progress>(
        film.empty() ? new_progress(session, candidates, plan) : progress_of(begun(), "kept"));
    try {
      return render(session, plan, progress);
    } catch (const Error&) {
      if (kept) *kept = bytes_of(*progress, plan);
      throw;
    }
  }
  static std::string bytes_of(Progress& progress, const Plan& plan) {
    progress.seconds = progress.cpu_seconds = progress.began = 0;
    FilmFacts facts;
    facts.processor = kGpuCode;
    return film_bytes(progress, plan, facts, {});
  }

  const Scene scene_ = read_gltf(two_rooms_path());
  const Vista vista_{scene_, scene_.camera(""), 24, 18, {portal_in_the_hole()}};
  const RenderTables tables_{vista_};
  int left_ = 0;
};

TEST_F(lost_device, keeps_all_whole_passes_and_another_goes_on_to_the_same_bytes) {
  const RenderResult whole = rendered(lost_after(-1));
  const std::string expected = bytes_of(*whole.progress, whole.plan);
  const int all = -1 - left_;
  for (const int steps : {all / 4, all / 2, all / 2 + 1, all - 1}) {
    std::string kept;
    EXPECT_THROW(rendered(lost_after(steps), &kept), Error);
    const uint64_t samples = parse_film(kept, "kept").film.samples();
    EXPECT_GT(samples, 0u);
    EXPECT_LT(samples, 9u);
    const RenderResult result = rendered(lost_after(-1), nullptr, kept);
    EXPECT_EQ(result.picture.pixels, whole.picture.pixels);
    EXPECT_EQ(bytes_of(*result.progress, result.plan), expected) << samples;
  }
}

// Twin: a renderer that adds half a pass before it fails corrupts the film.
class Careless : public SampleRenderer {
 public:
  explicit Careless(std::shared_ptr<SampleRenderer> sound, int passes)
      : SampleRenderer(sound->vista), sound_(std::move(sound)), left_(passes) {}
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally,
              ProgressBar& progress) override {
    if (left_-- > 0)
      return sound_->render(integrator, rules, round, samples, film, tally, progress);
    film.add(3, 3, Vec3d(1, 1, 1), 0, 0);
    throw Error(Exit::no_device, "lost");
  }
  uint64_t samples_of_pass() const override { return 1; }

 private:
  std::shared_ptr<SampleRenderer> sound_;
  int left_;
};

TEST_F(lost_device, twin_part_of_a_pass_in_the_film_is_caught) {
  const RenderResult whole = rendered(lost_after(-1));
  std::string kept;
  EXPECT_THROW(rendered(std::make_shared<Careless>(lost_after(-1), 4), &kept), Error);
  EXPECT_NE(rendered(lost_after(-1), nullptr, kept).picture.pixels, whole.picture.pixels);
}

}  // namespace tdpt::lost_device_test
