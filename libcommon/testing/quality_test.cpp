// --quality draft|normal|high: in each program with such knobs, every step is more accurate and
// takes more work. Work is counted, not timed: doc/efficiency.md has the seconds.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "libcommon/formats/light_grid.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::testing::quality_test {
namespace fs = std::filesystem;
using nlohmann::json;

const std::string kScene = TDPT_TESTDATA "/scenes/two-rooms.glb";
const std::array<std::string, 3> kQualities{"draft", "normal", "high"};

struct Point {
  double error, work;
};
using Curve = std::array<Point, 3>;

// Beyond noise: each step at least a fifth more accurate and a fifth more expensive.
bool ordered(const Curve& curve) {
  for (size_t k = 1; k < curve.size(); ++k)
    if (!(1.2 * curve[k].error < curve[k - 1].error && curve[k].work > 1.2 * curve[k - 1].work))
      return false;
  return true;
}

std::string told(const Curve& curve) {
  std::string text;
  for (const Point& p : curve)
    text += "error " + std::to_string(p.error) + ", work " + std::to_string(p.work) + "; ";
  return text;
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Quality : public ::testing::Test {
 protected:
  // Runs a program without progress and returns its summary.
  json run(const std::string& program, const std::string& words) {
    const std::string to = (folder_.path / (program + ".json")).string();
    const std::string command = TDPT_BIN "/" + program + " --json --no-provenance " + words +
                                (program == "exrdiff" ? "" : " --quiet") + " >" + to + " 2>" + to +
                                ".txt";
    EXPECT_EQ(std::system(command.c_str()), 0) << command << ": " << text_of(to + ".txt");
    return json::parse(text_of(to), nullptr, false);
  }
  std::string file(const std::string& name) const { return (folder_.path / name).string(); }

  // Mean or sum over some seeds from this one on.
  virtual Point point(const std::string& quality, int first_seed) = 0;

  void expect_ordered() {
    Curve curve, twin;  // twin: draft under three names
    for (size_t k = 0; k < curve.size(); ++k) {
      curve[k] = twin[k] = point(kQualities[k], 1);
      twin[k].error = k == 0 ? curve[0].error : point("draft", 101 * static_cast<int>(k)).error;
    }
    EXPECT_TRUE(ordered(curve)) << told(curve);
    EXPECT_FALSE(ordered(twin)) << "draft under three names: " << told(twin);
  }

  TempFolder folder_;
};

std::string words_of(const std::string& quality, int seed) {
  return "--quality " + quality + " --seed " + std::to_string(seed) + " ";
}

// Variation of several figures from seed to seed: the geometric mean of their standard deviations.
class Spread {
 public:
  void add(const std::vector<double>& figures) {
    if (sums_.empty()) sums_.resize(figures.size());
    for (size_t k = 0; k < figures.size(); ++k)
      sums_[k][0] += figures[k], sums_[k][1] += figures[k] * figures[k];
    ++seeds_;
  }
  double error() const {
    double log_error = 0;
    for (const auto& [sum, squares] : sums_) {
      const double mean = sum / seeds_;
      log_error += 0.5 * std::log(squares / seeds_ - mean * mean);
    }
    return std::exp(log_error / static_cast<double>(sums_.size()));
  }

 private:
  std::vector<std::array<double, 2>> sums_;
  int seeds_ = 0;
};

// ---- ffgraph: facts of the cut ----
class long_QualityOfGraphs : public Quality {
 protected:
  Point point(const std::string& quality, int first_seed) override {
    Spread spread;
    double work = 0;
    for (int s = 0; s < 6; ++s) {
      const json made =
          run("ffgraph", words_of(quality, first_seed + s) + kScene + " -o " + file("m"));
      work += made["light_hits"].get<double>() + made["camera_hits"].get<double>() +
              made["rays"].get<double>();
      const json facts = run("mincut", file("m") + " -o " + file("c"))["cuts"].at(0);
      spread.add({facts["conductance"], facts["carried"], facts["straight"], facts["seen"]});
    }
    return {spread.error(), work};
  }
};

TEST_F(long_QualityOfGraphs, each_step_tells_more_of_the_cut) {
  expect_ordered();
}

// ---- lightgrid: where and which way its lines cross the wall ----
class long_QualityOfLines : public Quality {
 protected:
  // Means and mean squares of positions and directions in the middle of the wall, x = 2.05.
  std::vector<double> moments() const {
    std::vector<double> sums(8, 0.0);
    double lines = 0;
    for (const LightLine& line : read_light_grid(file("g.vdb")).lines) {
      const Vec3d way = line.camera - line.light;
      const double there = (2.05 - line.light.x) / way.x;
      if (!(there > 0 && there < 1)) continue;
      const Vec3d at = line.light + way * there, w = normalize(way);
      size_t k = 0;
      for (const double x : {at.y - 1, at.z, w.y, w.z}) sums[k++] += x, sums[k++] += x * x;
      ++lines;
    }
    for (double& sum : sums) sum /= lines;
    return sums;
  }
  Point point(const std::string& quality, int first_seed) override {
    Spread spread;
    double work = 0;
    for (int s = 0; s < 10; ++s) {
      const json made = run("lightgrid", words_of(quality, first_seed + s) + kScene + " " +
                                             file("c") + " -o " + file("g.vdb"));
      spread.add(moments());
      work += made["tried"].get<double>();
    }
    return {spread.error(), work};
  }
};

TEST_F(long_QualityOfLines, each_step_tells_more_of_the_light) {
  run("ffgraph", kScene + " -o " + file("m"));
  run("mincut", file("m") + " -o " + file("c"));
  expect_ordered();
}

// ---- tdpt-render: relMSE ----
class QualityOfPictures : public Quality {
 protected:
  const std::string size_ =
      "--width 48 --integrator nee --max-depth 3 " TDPT_TESTDATA "/scenes/window.glb -o ";
  Point point(const std::string& quality, int first_seed) override {
    Point sum{0, 0};
    for (int s = 0; s < 4; ++s) {
      const json made =
          run("tdpt-render", words_of(quality, first_seed + s) + size_ + file("p.exr"));
      sum.work += made["spp"].get<double>();
      sum.error += run("exrdiff", file("p.exr") + " " + file("r.exr"))["relmse"].get<double>();
    }
    return sum;
  }
};

TEST_F(QualityOfPictures, each_step_is_nearer_to_a_reference) {
  run("tdpt-render", "--spp 4096 --seed 99 " + size_ + file("r.exr"));
  expect_ordered();
}

}  // namespace tdpt::testing::quality_test
