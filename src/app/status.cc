#include "app/status.h"

#include <gflags/gflags.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <streambuf>
#include <string_view>
#include <thread>

#include "trilobe/core/base/printable.h"

DEFINE_bool(quiet, false, "print no line on standard error that says what goes on");

namespace trilobe {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kTick(500);
constexpr seconds kSilence(2), kRepeat(60);
constexpr milliseconds kFresh(1500);  // how long what was shown stays before seconds are drawn

bool IsSet(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

size_t ErrorWidth() {
  constexpr int kUsual = 80;
  return static_cast<size_t>(TerminalColumns(STDERR_FILENO).value_or(kUsual));
}

// Cut so that it leaves the last column free, as a terminal may wrap there.
std::string Cut(const std::string& text, size_t width) {
  if (text.size() < width) return text;
  constexpr std::string_view kDots = "...";
  size_t end = width > kDots.size() + 1 ? width - kDots.size() - 1 : 0;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // in UTF-8
  return text.substr(0, end).append(kDots);
}

class Teller {
 public:
  static Teller& Get() {
    static Teller teller;
    return teller;
  }

  void Stage(const std::string& what) {
    const std::lock_guard lock(mutex_);
    if (is_silent_) return;
    what_ = what;
    began_ = told_ = Clock::now();
    shown_ = {};
    is_told_ = false;
    if (on_terminal_) Draw(what_);
    if (!ticker_.joinable()) {
      ticker_ = std::jthread([this](const std::stop_token& stop) { Tick(stop); });
    }
    changed_.notify_all();
  }

  void Show(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (is_silent_ || !on_terminal_) return;
    shown_ = Clock::now();
    Draw(text);
  }

  void Clear() {
    const std::lock_guard lock(mutex_);
    Erase();
  }

  void End() {
    const std::lock_guard lock(mutex_);
    what_.clear();
    Erase();
  }

  bool on_terminal() const { return on_terminal_; }

 private:
  Teller()
      : on_terminal_(
            isatty(STDERR_FILENO) != 0 && !IsSet("NO_COLOR") &&
            (std::getenv("TERM") == nullptr || std::string_view(std::getenv("TERM")) != "dumb")),
        is_silent_(FLAGS_quiet || IsSet("TRILOBE_TEST_QUIET")) {}

  ~Teller() {
    if (ticker_.joinable()) {
      ticker_.request_stop();
      changed_.notify_all();
      ticker_.join();
    }
    Erase();
  }

  void Tick(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
      changed_.wait_for(lock, kTick);
      if (what_.empty() || stop.stop_requested()) continue;
      const Clock::time_point now = Clock::now();
      const auto passed = std::chrono::duration_cast<seconds>(now - began_).count();
      if (on_terminal_) {
        if (passed > 0 && now - shown_ > kFresh) {
          Draw(what_ + "   " + std::to_string(passed) + " s");
        }
      } else if (now - told_ > (is_told_ ? kRepeat : kSilence)) {
        std::fprintf(stderr, "trilobe: %s%s\n", what_.c_str(),
                     is_told_ ? (", " + std::to_string(passed) + " s").c_str() : "");
        is_told_ = true;
        told_ = now;
      }
    }
  }

  void Draw(const std::string& text) {
    std::fprintf(stderr, "\r\033[K%s", Cut(text, ErrorWidth()).c_str());
    std::fflush(stderr);
    is_drawn_ = true;
  }

  void Erase() {
    if (is_drawn_) std::fputs("\r\033[K", stderr);
    is_drawn_ = false;
  }

  const bool on_terminal_, is_silent_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string what_;  // empty where nothing goes on
  Clock::time_point began_, told_, shown_;
  bool is_told_ = false, is_drawn_ = false;
  std::jthread ticker_;
};

}  // namespace

std::optional<int> TerminalColumns(int descriptor) {
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return std::nullopt;
  return size.ws_col;
}

// Hands on to the buffer of a stream.
class LineClearing::Buffer : public std::streambuf {
 public:
  explicit Buffer(std::ostream* stream) : stream_(*stream), to_(stream->rdbuf(this)) {}
  ~Buffer() override { stream_.rdbuf(to_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

 protected:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    Status::Clear();
    return to_->sputc(traits_type::to_char_type(c));
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    Status::Clear();
    return to_->sputn(text, size);
  }
  int sync() override { return to_->pubsync(); }

 private:
  std::ostream& stream_;
  std::streambuf* const to_;
};

LineClearing::LineClearing() {
  if (!Status::OnTerminal()) return;
  out_ = std::make_unique<Buffer>(&std::cout);
  error_ = std::make_unique<Buffer>(&std::cerr);
}

LineClearing::~LineClearing() = default;

void Status::Stage(const std::string& what) { Teller::Get().Stage(Printable(what)); }
void Status::Show(const std::string& text) { Teller::Get().Show(text); }
void Status::Clear() { Teller::Get().Clear(); }
void Status::End() { Teller::Get().End(); }
bool Status::OnTerminal() { return Teller::Get().on_terminal(); }

}  // namespace trilobe
