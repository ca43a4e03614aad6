#include "io/pictures/gnuplot.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <ostream>
#include <sstream>
#include <string_view>
#include <thread>

#include "core/base/text.h"
#include "core/files/file.h"
#include "core/files/own_mark.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr const char* kNoGnuplot =
    "pictures need gnuplot, which is not on the PATH; install the package gnuplot-nox";

std::string ReadAll(std::FILE* file) {
  std::rewind(file);
  std::string bytes;
  std::array<char, 1 << 16> buffer;
  while (const size_t n = std::fread(buffer.data(), 1, buffer.size(), file)) {
    bytes.append(buffer.data(), n);
  }
  return bytes;
}

// The line of gnuplot's complaint that says what is wrong.
std::string ErrorLine(const std::string& message) {
  std::string best;
  for (size_t begin = 0; begin < message.size();) {
    const size_t end = std::min(message.find('\n', begin), message.size());
    const std::string line = message.substr(begin, end - begin);
    if (line.find_first_not_of(" \t^") != std::string::npos) best = line;
    begin = end + 1;
  }
  return best.empty() ? "no message" : best;
}

// Its status, as of waitpid; nothing if it goes on after the limit.
std::optional<int> WaitFor(pid_t pid, double max_seconds) {
  constexpr auto kPause = std::chrono::milliseconds(5);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(max_seconds);
  while (std::chrono::steady_clock::now() < end) {
    int status = 0;
    const pid_t ended = waitpid(pid, &status, WNOHANG);
    // No status is kept if the parent process ignores SIGCHLD; then the picture tells.
    if (ended == pid || (ended < 0 && errno == ECHILD)) return status;
    std::this_thread::sleep_for(kPause);
  }
  return std::nullopt;
}

// A format of pictures: gnuplot's terminal for a size in pixels, and how a whole file begins and
// ends.
struct PictureFormat {
  std::string_view ending;
  std::string terminal;
  std::string_view begins, ends;
};

PictureFormat FormatOf(std::string_view ending, int width, int height) {
  using std::string_view_literals::operator""sv;
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  // An inch of print has 100 of these pixels.
  const std::string inches = GnuplotNumber(width / 100.0) + "," + GnuplotNumber(height / 100.0);
  if (ending == ".svg") {
    return {".svg", "svg enhanced size " + size + " font 'DejaVu Sans,15'", "<?xml"sv,
            "</svg>\n\n"sv};
  }
  if (ending == ".pdf") {
    return {".pdf", "pdfcairo enhanced size " + inches + " font 'DejaVu Sans,13'", "%PDF-"sv,
            "%%EOF\n"sv};
  }
  // The chunk that ends every PNG picture: no data, its name, and the checksum of that.
  return {".png", "pngcairo enhanced size " + size + " font 'DejaVu Sans,18'",
          "\x89PNG\r\n\x1A\n"sv, "\0\0\0\0IEND\xAE\x42\x60\x82"sv};
}

// gnuplot's standard output for a script on its standard input. Both go through files where the
// picture will be: unlike pipes, these cannot block one side on the other.
std::string RunGnuplot(const std::string& path, const PictureFormat& format,
                       const std::string& script, double max_seconds) {
  const NamelessFile in = MakeNamelessFile(path), out = MakeNamelessFile(path),
                     err = MakeNamelessFile(path);
  if (std::fwrite(script.data(), 1, script.size(), in.get()) != script.size() ||
      std::fflush(in.get()) != 0) {
    throw Error(ErrorKind::kFile,
                "cannot write what gnuplot reads beside '" + path + "': " + std::strerror(errno))
        .At(path)
        .About("write", std::strerror(errno));
  }
  std::rewind(in.get());

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(in.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(out.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(err.get()), STDERR_FILENO);
  std::string program = "gnuplot", defaults = "--default-settings";
  char* const arguments[] = {program.data(), defaults.data(), nullptr};
  pid_t pid = 0;
  // In a process group of its own, so that it can be ended with all that it started.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int failure = posix_spawnp(&pid, "gnuplot", &actions, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) throw Error(ErrorKind::kMissing, kNoGnuplot).About("gnuplot");
  if (failure != 0) {
    throw Error(ErrorKind::kFile, std::string("cannot run gnuplot: ") + std::strerror(failure))
        .About("gnuplot", std::strerror(failure));
  }

  const std::optional<int> status = WaitFor(pid, max_seconds);
  if (!status) {
    kill(-pid, SIGKILL);
    while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
    }
    throw Error(ErrorKind::kLimit, "gnuplot was stopped, as it had not drawn the picture after " +
                                       GnuplotNumber(max_seconds) + " seconds")
        .About("gnuplot", max_seconds);
  }
  if (!WIFEXITED(*status) || WEXITSTATUS(*status) != 0) {
    throw Error(ErrorKind::kFile, "gnuplot failed: " + ErrorLine(ReadAll(err.get())))
        .About("gnuplot", "failed");
  }
  std::string picture = ReadAll(out.get());
  if (!picture.starts_with(format.begins)) {
    throw Error(ErrorKind::kFile, "gnuplot drew no picture: " + ErrorLine(ReadAll(err.get())))
        .About("gnuplot", "no picture");
  }
  if (!picture.ends_with(format.ends)) {
    throw Error(ErrorKind::kFile,
                "gnuplot drew a part of the picture alone: " + ErrorLine(ReadAll(err.get())))
        .About("gnuplot", "part of a picture");
  }
  return picture;
}

std::string CommonStyle(const PictureFormat& format) {
  return "set encoding utf8\n"
         "set terminal " +
         format.terminal +
         " background '#FFFFFF' linewidth 1\n"
         "set border 3 linecolor '#555555' linewidth 1.5\n"
         "set tics nomirror out textcolor '#333333'\n"
         "set grid xtics ytics linecolor '#E4E4E4' linetype 1 linewidth 1\n"
         "set key samplen 2 spacing 1.15 noenhanced textcolor '#222222'\n"
         "set title textcolor '#111111'\n"
         "set xlabel textcolor '#222222'\n"
         "set ylabel textcolor '#222222'\n";
}

}  // namespace

std::string GnuplotQuote(std::string_view text) {
  std::string quoted = "'";
  while (!text.empty()) {
    const size_t length = Utf8Length(text);
    const auto byte = static_cast<unsigned char>(text[0]);
    if (length == 0 || byte < 0x20 || byte == 0x7F) {
      quoted += '?';
    } else if (byte == '\'') {
      quoted += "\u2019";
    } else {
      quoted += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return quoted + "'";
}

std::string GnuplotTitle(std::string_view text, int width, int size) {
  std::string title = GnuplotQuote(text);
  // A letter is some 0.62 of its height wide, which is 4/3 pixels a point.
  constexpr double kLetterWidth = 0.62 * 4 / 3;
  constexpr int kSmallest = 12;
  const double room = 0.94 * width / kLetterWidth;
  const auto begins_letter = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  const auto letters = static_cast<double>(std::ranges::count_if(title, begins_letter));
  if (const double most = room / kSmallest; letters > most) {
    size_t end = static_cast<size_t>(most) - 2;
    while (!begins_letter(title[end])) --end;
    title = title.substr(0, end) + "…'";
  }
  return title + " noenhanced font '," +
         std::to_string(std::clamp(static_cast<int>(room / letters), kSmallest, size)) + "'";
}

std::string GnuplotNumber(double x) {
  if (!std::isfinite(x)) return "NaN";
  std::array<char, 32> buffer;
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), x, std::chars_format::general, 8);
  return {buffer.data(), end.ptr};
}

std::string GnuplotData(std::string_view name, std::span<const std::vector<double>> rows) {
  std::string block = '$' + std::string(name) + " << EOD\n";
  for (const std::vector<double>& row : rows) {
    for (const double x : row) block += GnuplotNumber(x) + ' ';
    block += '\n';
  }
  return block + "EOD\n";
}

AxisRange LogRange(std::span<const double> values, double decades) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const double x : values) {
    if (!(x > 0 && std::isfinite(x))) continue;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  if (high == 0) low = high = 1;
  low = std::max(low, high * std::pow(10, -decades));
  const double margin = std::max(std::pow(high / low, 0.05), 1.25);
  return {low / margin, high * margin};
}

std::string GnuplotLogRange(std::span<const double> values, double decades) {
  const auto [low, high] = LogRange(values, decades);
  return '[' + GnuplotNumber(low) + ':' + GnuplotNumber(high) + ']';
}

std::string LogTics(const AxisRange& range, char axis) {
  const std::string format = std::string("set format ") + axis, set = std::string("set ") + axis;
  if (range.high > 100 * range.low) return format + " '10^{%T}'\n" + set + "tics autofreq\n";
  std::string tics;
  for (double decade = std::pow(10, std::floor(std::log10(range.low))); decade <= range.high;
       decade *= 10) {
    for (const int digit : {1, 2, 5}) {
      tics += (tics.empty() ? "" : ", ") + GnuplotNumber(digit * decade);
    }
  }
  return format + " '%g'\n" + set + "tics (" + tics + ")\n";
}

bool HaveGnuplot() {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((std::filesystem::path(folder) / "gnuplot").c_str(), X_OK) == 0) return true;
  }
  return false;
}

void RequireGnuplot() {
  if (!HaveGnuplot()) throw Error(ErrorKind::kMissing, kNoGnuplot).About("gnuplot");
}

namespace {

void Draw(const std::string& path, const PictureFormat& format, const std::string& script,
          double max_seconds) {
  const std::string picture =
      MarkedPicture(RunGnuplot(path, format, CommonStyle(format) + script, max_seconds));
  WriteFile(path, [&](std::ostream& out) {
    out.write(picture.data(), static_cast<std::streamsize>(picture.size()));
  });
}

}  // namespace

void DrawPng(const std::string& path, int width, int height, const std::string& script,
             double max_seconds) {
  Draw(path, FormatOf(".png", width, height), script, max_seconds);
}

void DrawVectors(const std::string& path, int width, int height, const std::string& script,
                 double max_seconds) {
  const std::string ending = EndingOf(path);
  if (ending != ".svg" && ending != ".pdf") {
    throw Error(ErrorKind::kUnsupported, "'" + path + "': a picture of vectors is .svg or .pdf")
        .At(path)
        .About("ending", ending);
  }
  Draw(path, FormatOf(ending, width, height), script, max_seconds);
}

}  // namespace trilobe
