// The command line of tdpt-render, and what it asks for; tdpt-render(1) explains the options.
#pragma once
#include <string>
#include <vector>

#include "libcommon/film/film.h"
#include "libcommon/options/render_options.h"
#include "tools/tdpt-render/plan/plan.h"

namespace tdpt {

/// Declares the program's options, which fill in `a`.
void declare_options(cli::Options& options, RenderArguments& a);

/// Throws UsageError for options that contradict each other.
void check_options(const RenderArguments& a);

/// Throws UsageError if numbers for guided walks are given to an integrator that has none.
Job job_of(const RenderArguments& a, const cli::Common& common);

/// Whether the film keeps its halves, for the filter or for --aov.
bool keeps_halves(const RenderArguments& a);
/// The names of --aov, each once, in the order of kFeatures and kDerived. Throws UsageError for an
/// unknown one.
std::vector<std::string> aovs_of(const RenderArguments& a);

/// The samples of "I/N", the I-th of N parts of a picture of so many; parts differ by at most one
/// sample. Throws UsageError.
SampleRange samples_of_shard(const std::string& shard, uint64_t samples);

}  // namespace tdpt
