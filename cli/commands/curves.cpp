#include "cli/commands/curves.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/curve_plot.hpp"
#include "cli/commands/inputs.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/resources.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {
namespace {

// The frames to sample: a list, or first, first + step, ….
struct Frames {
  std::vector<double> listed;
  double first = 0;
  double step = 1;
  std::size_t count = 0;

  double operator[](std::size_t k) const {
    return listed.empty() ? first + static_cast<double>(k) * step : listed[k];
  }
};

// Reads one number per line; empty lines are skipped.
Result<Frames> read_frames(const std::string& file) {
  const auto text = read_file(file, largest_scene_file, &was_interrupted);
  if (!text) return fail(text.error());
  Frames frames;
  std::string_view rest = *text;
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view word = trim(rest.substr(0, end), " \t\r");
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (word.empty()) continue;
    const auto frame = to_number(word);
    if (!frame) {
      return fail(ErrorCode::InvalidInput,
                  "this is not a frame; each line must have one finite number", file, line);
    }
    frames.listed.push_back(*frame);
  }
  frames.count = frames.listed.size();
  return frames;
}

// Parses A:B or one frame: any finite numbers, also outside the scene's range.
Result<Frames> frames_asked(const CurvesOptions& options, const Scene& scene) {
  const auto usage = [](std::string message) {
    return fail(ErrorCode::InvalidInput, std::move(message));
  };
  double first = scene.start, last = scene.end;
  if (!options.frames.empty()) {
    const std::size_t colon = options.frames.find(':');
    const auto from = to_number(std::string_view(options.frames).substr(0, colon));
    const auto to = colon == std::string::npos
                        ? from
                        : to_number(std::string_view(options.frames).substr(colon + 1));
    if (!from || !to || *from > *to) {
      return usage(
          fmt::format("--frames {}: must be one frame, or A:B with A <= B", options.frames));
    }
    first = *from;
    last = *to;
  }
  constexpr double most = 1e9;
  // If the steps reach the last frame up to rounding, the last frame is included.
  const double steps = std::floor((last - first) / options.step * (1 + 1e-14) + 1e-9);
  if (!(steps < most)) {
    return usage(fmt::format("frames {} to {} in steps of {} are too many; at most {} are allowed",
                             first, last, options.step, most));
  }
  return Frames{{}, first, options.step, static_cast<std::size_t>(steps) + 1};
}

Result<std::vector<NamedChannel>> choose_channels(const Scene& scene,
                                                  const std::vector<std::string>& paths) {
  const std::vector<NamedChannel> all = channels_of(scene);
  std::vector<NamedChannel> chosen;
  if (paths.empty()) {
    std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
                 [](const NamedChannel& channel) { return channel.is_animated(); });
    return chosen;
  }
  std::map<std::string_view, const NamedChannel*> named;
  for (const NamedChannel& channel : all) named.emplace(channel.path, &channel);
  for (const std::string& path : paths) {
    const auto found = named.find(path);
    if (found == named.end()) {
      return invalid(fmt::format("--channel {}: {}", path, no_channel(scene, path)));
    }
    chosen.push_back(*found->second);
  }
  return chosen;
}

// The destination of the rows: stdout, or a file that appears complete or not at all.
class TextOutput {
 public:
  static Result<TextOutput> open(const std::string& file) {
    if (file.empty()) return TextOutput({});
    auto created = AtomicFile::create(file);
    if (!created) return fail(created.error());
    return TextOutput(*std::move(created));
  }

  Result<void> write(std::string_view text) {
    if (file_) return file_->write(text);
    print(stdout, text);
    if (!is_lost()) return {};
    return fail(ErrorCode::Unwritable, "cannot write to the standard output");
  }

  Result<void> finish() {
    if (file_) return file_->commit();
    return {};
  }

  /// Whether a write to stdout failed; every command reports this at its end.
  static bool is_lost() { return std::ferror(stdout) != 0; }

 private:
  explicit TextOutput(std::optional<AtomicFile> file) : file_(std::move(file)) {}

  std::optional<AtomicFile> file_;
};

// Rows `channel,frame,value`; each number is the shortest text that reads back to the same double.
class Table {
 public:
  Table(TextOutput& output, const Frames& frames, bool has_sides)
      : output_(output), frames_(frames), has_sides_(has_sides) {}

  Result<void> write(std::span<const NamedChannel> channels) {
    text_ = has_sides_ ? "channel,frame,value,value_left,velocity,velocity_left\n"
                       : "channel,frame,value\n";
    for (const NamedChannel& channel : channels) {
      auto written = std::visit([&](const auto* held) { return write(channel.path, plain(*held)); },
                                channel.channel);
      if (!written) return written;
    }
    return output_.write(text_);
  }

 private:
  template <int D>
  static const Channel<D>& plain(const Channel<D>& channel) {
    return channel;
  }
  static const Channel<1>& plain(const Switch& channel) { return channel.channel(); }

  template <int D>
  Result<void> write(const std::string& path, const Channel<D>& channel) {
    std::optional<Sampler<D>> sampler;
    if (channel.is_animated()) sampler.emplace(channel.curve());
    for (std::size_t k = 0; k < frames_.count; ++k) {
      const double frame = frames_[k];
      fmt::format_to(std::back_inserter(text_), "{},{}", path, frame);
      append<D>(sampler ? sampler->value(frame) : channel.at(frame));
      if (has_sides_) {
        append<D>(sampler ? sampler->left_value(frame) : channel.at(frame));
        append<D>(sampler ? sampler->velocity(frame) : Value<D>{});
        append<D>(sampler ? sampler->left_velocity(frame) : Value<D>{});
      }
      text_ += '\n';
      if (text_.size() < chunk) continue;
      if (was_interrupted()) {
        return fail(ErrorCode::Interrupted, fmt::format("interrupted at frame {}", frame));
      }
      if (auto written = output_.write(text_); !written) return written;
      text_.clear();
    }
    return {};
  }

  template <int D>
  void append(const Value<D>& value) {
    for (const double component : value) {
      fmt::format_to(std::back_inserter(text_), ",{}", component);
    }
  }

  static constexpr std::size_t chunk = std::size_t{1} << 20;

  TextOutput& output_;
  const Frames& frames_;
  bool has_sides_;
  std::string text_;
};

// Plots from the first to the last requested frame.
Result<void> write_plot(TextOutput& output, std::span<const NamedChannel> channels,
                        const Frames& frames, const CurvesOptions& options) {
  if (frames.count == 0)
    return fail(ErrorCode::InvalidInput, "a plot needs at least two frames; there are none");
  double first = frames[0], last = frames[frames.count - 1];
  for (const double frame : frames.listed) {
    first = std::min(first, frame);
    last = std::max(last, frame);
  }
  if (!(first < last)) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("a plot needs at least two frames; there is only {}", first));
  }
  const std::string title = std::filesystem::path(options.scene).filename().string();
  const std::string plot = curve_plot(channels, first, last, title, &was_interrupted);
  if (was_interrupted()) return interrupted();
  return output.write(plot);
}

// Checks that the output is not one of the inputs.
Result<void> check_place(const CurvesOptions& options, const Scene& scene) {
  if (options.out.empty()) return {};
  if (!options.at.empty() && name_one_file(options.out, options.at))
    return refuse_output("-o", options.out, "it is the file of --at");
  return check_no_input("-o", options.out, scene);
}

}  // namespace

void add_curves(CLI::App& app, CurvesOptions& options) {
  CLI::App* curves = app.add_subcommand("curves", "Sample channels of a scene at full precision");
  curves->add_option("SCENE", options.scene, "Scene file")->required();
  curves->add_option("--channel", options.channels,
                     "Channels, as NAME.attribute; all animated channels by default");
  auto* frames = curves->add_option("--frames", options.frames,
                                    "Frames, A:B or one, which may be fractional and outside the "
                                    "scene's range; the scene's frames by default");
  auto* step = curves->add_option("--step", options.step, "Frames from one row to the next")
                   ->check(number_from(1e-9))
                   ->capture_default_str();
  curves->add_option("--at", options.at, "File with the frames, one per line")
      ->excludes(frames)
      ->excludes(step);
  curves
      ->add_option("-o,--out", options.out,
                   "Output file, a .csv table or an .svg plot; CSV on stdout by default")
      ->check(file_name());
  add_root(*curves, options.root);
  add_changes(*curves, options.changes);
  curves->add_flag("--sides", options.has_sides,
                   "Add left value, velocity and left velocity (per frame) to each row");
}

int run_curves(const CurvesOptions& options) {
  catch_interrupts();
  if (!options.out.empty()) {
    if (auto place = check_output_file("-o", options.out); !place) return report(place.error());
  }
  const std::string ending = ending_of(options.out);
  if (!options.out.empty() && ending != ".csv" && ending != ".svg") {
    return report({ErrorCode::InvalidInput,
                   fmt::format("{}: no format has the ending \"{}\"; allowed: .csv, .svg",
                               options.out, ending)});
  }
  const auto scene = read_scene(options.scene, options.root, options.changes);
  if (!scene) return report(scene.error());
  const auto channels = choose_channels(*scene, options.channels);
  if (!channels) return report(channels.error());
  const auto frames = options.at.empty() ? frames_asked(options, *scene) : read_frames(options.at);
  if (!frames) return report(frames.error());

  if (auto free = check_place(options, *scene); !free) return report(free.error());
  auto output = TextOutput::open(options.out);
  if (!output) return report(output.error());
  auto written = ending == ".svg" ? write_plot(*output, *channels, *frames, options)
                                  : Table(*output, *frames, options.has_sides).write(*channels);
  if (TextOutput::is_lost()) return exit_failed;
  if (!written) {
    return report(with_kept(written.error(), options.out.empty()
                                                 ? "the rows printed so far are complete"
                                                 : "no file was written"));
  }
  if (auto finished = output->finish(); !finished) return report(finished.error());
  return exit_done;
}

}  // namespace pliant::cli
