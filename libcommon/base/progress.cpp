#include "libcommon/base/progress.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "libcommon/base/words.h"

namespace tdpt {
namespace {

std::atomic<ProgressForm> form_of_all{ProgressForm::automatic};

std::string quoted(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      json += fmt::format("\\u{:04x}", static_cast<int>(c));
    else
      json += c;
  }
  return json + "\"";
}

}  // namespace

void say(const std::string& line) {
  std::fputs((line + "\n").c_str(), stderr);
}

void show_progress_as(ProgressForm form) {
  form_of_all = form;
}

ProgressForm progress_form(bool quiet) {
  const ProgressForm form = form_of_all;
  if (form != ProgressForm::automatic) return form;
  return !quiet && ::isatty(STDERR_FILENO) ? form : ProgressForm::none;
}

ProgressBar::ProgressBar(std::string what, std::string unit, uint64_t total, bool quiet)
    : what_(std::move(what)), unit_(std::move(unit)), total_(total), form_(progress_form(quiet)) {}

ProgressBar::~ProgressBar() {
  if (form_ == ProgressForm::json) show();
  if (form_ == ProgressForm::automatic && next_ms_ > 300) std::fputs("\r\033[K", stderr);
}

double ProgressBar::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void ProgressBar::advance(uint64_t n) {
  done_ += n;
  if (form_ == ProgressForm::none) return;
  int64_t due = next_ms_.load();
  const auto now_ms = static_cast<int64_t>(seconds() * 1000);
  if (now_ms >= due && next_ms_.compare_exchange_strong(due, now_ms + 300)) show();
}

ProgressBar::Figures ProgressBar::figures() const {
  Figures f{done_, seconds(), 0, -1, 0};
  f.rate = static_cast<double>(f.done) / std::max(f.seconds, 1e-9);
  if (total_ > 0 && f.done > 0) {
    f.left = static_cast<double>(total_ - std::min(f.done, total_)) / f.rate;
    f.share = static_cast<double>(f.done) / static_cast<double>(total_);
  } else if (total_ == 0 && lasts_ > 0) {
    f.left = std::max(lasts_ - f.seconds, 0.0);
    f.share = std::min(f.seconds / lasts_, 1.0);
  }
  return f;
}

std::string ProgressBar::line(const Figures& f) const {
  std::string text =
      fmt::format("\r\033[K{}: {} {}, {}/s", what_, f.done, unit_, number_words(f.rate));
  if (f.left >= 0) text += fmt::format(", {:.0f} %, {:.0f} s left", 100 * f.share, f.left);
  return more_.empty() ? text : text + ", " + more_;
}

std::string ProgressBar::json(const Figures& f) const {
  const auto or_null = [](bool known, const std::string& value) { return known ? value : "null"; };
  return fmt::format(
      R"({{"progress": {{"what": {}, "unit": {}, "done": {}, "total": {}, "seconds": {:.3f}, )"
      R"("rate": {:.6g}, "left": {}{}}}}})"
      "\n",
      quoted(what_), quoted(unit_), f.done, or_null(total_ > 0, fmt::to_string(total_)), f.seconds,
      f.rate, or_null(f.left >= 0, fmt::format("{:.3f}", f.left)),
      more_.empty() ? "" : ", \"note\": " + quoted(more_));
}

void ProgressBar::show() {
  const std::lock_guard lock(showing_);
  const Figures f = figures();
  std::fputs((form_ == ProgressForm::json ? json(f) : line(f)).c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace tdpt
