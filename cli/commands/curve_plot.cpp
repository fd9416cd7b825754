#include "cli/commands/curve_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/timeline/sampler.hpp"

namespace pliant::cli {
namespace {

// In pixels.
constexpr double width = 960;
constexpr double left_margin = 76;
constexpr double right_margin = 24;
constexpr double top_margin = 52;
constexpr double header = 26;  // of a panel, for its name and legend
constexpr double panel_height = 190;
constexpr double panel_gap = 34;
constexpr double bottom_margin = 12;
constexpr double samples_a_pixel = 2;

constexpr std::string_view style = R"(<style>
  text { font: 12px system-ui, sans-serif; fill: #5b6472; }
  .title { font-size: 15px; font-weight: 600; fill: #1c2330; }
  .name { font-size: 13px; font-weight: 600; fill: #1c2330; }
  .back { fill: #ffffff; }
  .panel { fill: #f7f8fa; stroke: #c9d0da; }
  .grid { stroke: #e4e8ee; } .zero { stroke: #aab3c0; }
  .curve { fill: none; stroke-width: 2; stroke-linejoin: round; }
  .outside { stroke-dasharray: 5 4; opacity: 0.65; }
  .c0 { stroke: #2563c9; } .c1 { stroke: #c2362f; } .c2 { stroke: #2a8a4a; } .c3 { stroke: #2563c9; }
  .k0 { fill: #2563c9; } .k1 { fill: #c2362f; } .k2 { fill: #2a8a4a; } .k3 { fill: #2563c9; }
  .key { stroke: #ffffff; } .handle { stroke: #8a94a3; } .tip { fill: #ffffff; stroke: #8a94a3; }
  @media (prefers-color-scheme: dark) {
    text { fill: #a3adba; } .title, .name { fill: #eef1f5; }
    .back { fill: #14171c; } .panel { fill: #1b2027; stroke: #3a424e; }
    .grid { stroke: #272e38; } .zero { stroke: #596474; }
    .c0 { stroke: #77a8ff; } .c1 { stroke: #ff8078; } .c2 { stroke: #6fd48f; } .c3 { stroke: #77a8ff; }
    .k0 { fill: #77a8ff; } .k1 { fill: #ff8078; } .k2 { fill: #6fd48f; } .k3 { fill: #77a8ff; }
    .key { stroke: #14171c; } .handle { stroke: #7c8796; } .tip { fill: #14171c; stroke: #7c8796; }
  }
</style>
)";

// A step of 1, 2 or 5 times a power of ten, so that about `count` steps fill `extent`.
double nice_step(double extent, double count) {
  const double rough = extent / count;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10 * power;
}

std::string coordinate(double pixels) {
  std::string text = fmt::format("{:.2f}", std::clamp(pixels, -1e6, 1e6));
  while (text.ends_with('0')) text.pop_back();
  if (text.ends_with('.')) text.pop_back();
  return text;
}

struct Point {
  double x = 0;
  double y = 0;
};

// Maps frames and values to pixels.
struct Panel {
  double first = 0;
  double last = 1;
  double low = 0;
  double high = 1;
  double top = 0;  // of the plotted area [px]

  double x(double frame) const {
    return left_margin + (frame - first) / (last - first) * (width - left_margin - right_margin);
  }
  double y(double value) const { return top + (1 - (value - low) / (high - low)) * panel_height; }
  Point at(double frame, double value) const { return {x(frame), y(value)}; }
};

// A line through points, leaving out those that it passes through anyway.
class Path {
 public:
  void move_to(Point point) {
    draw();
    text_ += fmt::format("M{} {}", coordinate(point.x), coordinate(point.y));
    start_ = point;
  }

  void line_to(Point point) {
    constexpr std::size_t most_passed = 50;  // each is checked again for every new point
    const bool passes_all = passed_.size() < most_passed &&
                            std::all_of(passed_.begin(), passed_.end(), [&](Point passed) {
                              return is_passed(start_, passed, point);
                            });
    if (!passes_all) draw();
    passed_.push_back(point);
  }

  std::string take() {
    draw();
    return std::move(text_);
  }

 private:
  // Whether the straight line from a to c passes b: within a twentieth of a pixel, and b is not
  // beyond a or c.
  static bool is_passed(Point a, Point b, Point c) {
    const double length = std::hypot(c.x - a.x, c.y - a.y);
    const double area = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    return area <= 0.05 * length && (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) >= 0;
  }

  void draw() {
    if (passed_.empty()) return;
    start_ = passed_.back();
    text_ += fmt::format("L{} {}", coordinate(start_.x), coordinate(start_.y));
    passed_.clear();
  }

  std::string text_;
  Point start_;
  std::vector<Point> passed_;  // points since `start_`; the last one is the present end
};

constexpr std::size_t parts_of_key = 1024;  // of the work for each, see StopPoll

template <int D>
class ChannelPlot {
 public:
  ChannelPlot(const Channel<D>& channel, const std::string& path, bool is_switch, double first,
              double last, double top, StopPoll& poll)
      : channel_(channel),
        path_(path),
        is_switch_(is_switch),
        panel_{first, last, 0, 1, top + header},
        poll_(poll) {
    if (channel.is_animated()) handles_ = channel.curve().handles();
    choose_range();
  }

  std::string draw() {
    text_ = fmt::format("<g>\n<text class=\"name\" x=\"{}\" y=\"{}\">{}</text>\n",
                        coordinate(left_margin), coordinate(panel_.top - 9), path_);
    draw_legend();
    text_ += fmt::format("<rect class=\"panel\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
                         coordinate(left_margin), coordinate(panel_.top),
                         coordinate(width - left_margin - right_margin), coordinate(panel_height));
    draw_grid();
    text_ += fmt::format(
        "<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">\n",
        coordinate(left_margin), coordinate(panel_.top),
        coordinate(width - left_margin - right_margin), coordinate(panel_height));
    for (int c = 0; c < D; ++c) draw_curve(c);
    for (int c = 0; c < D; ++c) draw_handles(c);
    text_ += "</svg>\n";
    for (int c = 0; c < D; ++c) draw_keys(c);
    text_ += "</g>\n";
    return std::move(text_);
  }

 private:
  // The value range: the curve's exact extrema between its keys, with some margin. Handles and the
  // curve outside its keys extend it by at most its height on each side, so that they do not
  // flatten the curve.
  void choose_range() {
    if (!channel_.is_animated()) {
      const Value<D> value = channel_.at(panel_.first);
      panel_.low = *std::min_element(value.begin(), value.end());
      panel_.high = *std::max_element(value.begin(), value.end());
    } else {
      const auto& keys = channel_.curve().keys().keys;
      const double from = std::clamp(keys.front().frame, panel_.first, panel_.last);
      const double to = std::clamp(keys.back().frame, panel_.first, panel_.last);
      std::tie(panel_.low, panel_.high) = extent(from, to);
      const double room = panel_.high > panel_.low ? panel_.high - panel_.low
                                                   : std::numeric_limits<double>::infinity();
      const double lowest = panel_.low - room, highest = panel_.high + room;
      const auto include = [&](double value) {
        if (std::isnan(value)) return;
        panel_.low = std::min(panel_.low, std::max(value, lowest));
        panel_.high = std::max(panel_.high, std::min(value, highest));
      };
      const auto [low, high] = extent(panel_.first, panel_.last);
      include(low);
      include(high);
      for (const KeyHandle<D>& handle : handles_) {
        if (!is_seen(handle.frame)) continue;
        for (const double value : handle.value) include(value);
      }
    }
    constexpr double largest = 1e300;
    panel_.low = std::clamp(panel_.low, -largest, largest);
    panel_.high = std::clamp(panel_.high, -largest, largest);
    const double air = panel_.high > panel_.low ? 0.08 * (panel_.high - panel_.low)
                                                : std::max(1.0, 0.1 * std::abs(panel_.high));
    panel_.low -= air;
    panel_.high += air;
  }

  std::pair<double, double> extent(double from, double to) const {
    const auto range = channel_.curve().range(from, to);
    return {*std::min_element(range.low.begin(), range.low.end()),
            *std::max_element(range.high.begin(), range.high.end())};
  }

  bool is_seen(double frame) const { return frame >= panel_.first && frame <= panel_.last; }

  // One component has the first colour, three have x, y, z in red, green and blue.
  static int colour(int component) { return D == 1 ? 0 : component + 1; }

  void draw_legend() {
    double x = width - right_margin;
    const auto entry = [&](std::string_view label, std::string_view mark) {
      x -= 8.0 * static_cast<double>(label.size()) + 26;
      text_ +=
          fmt::format("<g transform=\"translate({} {})\">{}<text x=\"20\" y=\"4\">{}</text></g>\n",
                      coordinate(x), coordinate(panel_.top - 13), mark, label);
    };
    if (!handles_.empty()) {
      entry("handle",
            "<path class=\"handle\" d=\"M0 0H11\"/><circle class=\"tip\" cx=\"12\" r=\"3\"/>");
    }
    if (channel_.is_animated()) entry("key", "<path class=\"key k0\" d=\"M8 -5l5 5-5 5-5-5z\"/>");
    for (int c = D - 1; D > 1 && c >= 0; --c) {
      entry(std::string_view("xyz").substr(static_cast<std::size_t>(c), 1),
            fmt::format("<path class=\"curve c{}\" d=\"M0 0H14\"/>", colour(c)));
    }
  }

  void draw_grid() {
    const double value_step = is_switch_ ? 1 : nice_step(panel_.high - panel_.low, 5);
    for (double k = std::ceil(panel_.low / value_step); k * value_step <= panel_.high; ++k) {
      const std::string y = coordinate(panel_.y(k * value_step));
      text_ += fmt::format("<path class=\"{}\" d=\"M{} {}H{}\"/>\n", k == 0 ? "zero" : "grid",
                           coordinate(left_margin), y, coordinate(width - right_margin));
      text_ += fmt::format("<text x=\"{}\" y=\"{}\" dy=\"4\" text-anchor=\"end\">{}</text>\n",
                           coordinate(left_margin - 8), y, value_label(k * value_step));
    }
    const double frame_step = std::max(nice_step(panel_.last - panel_.first, 12),
                                       std::min(1.0, panel_.last - panel_.first));
    for (double k = std::ceil(panel_.first / frame_step); k * frame_step <= panel_.last; ++k) {
      const std::string x = coordinate(panel_.x(k * frame_step));
      text_ += fmt::format("<path class=\"grid\" d=\"M{} {}v{}\"/>\n", x, coordinate(panel_.top),
                           coordinate(panel_height));
      text_ += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{:g}</text>\n", x,
                           coordinate(panel_.top + panel_height + 16), k * frame_step + 0.0);
    }
  }

  std::string value_label(double value) const {
    if (is_switch_) return value == 0 ? "false" : value == 1 ? "true" : "";
    return fmt::format("{:g}", value + 0.0);  // not -0
  }

  void draw_curve(int c) {
    if (!channel_.is_animated()) {
      const double value = channel_.at(panel_.first)[c];
      Path path;
      path.move_to(panel_.at(panel_.first, value));
      path.line_to(panel_.at(panel_.last, value));
      add_path(path.take(), c, false);
      return;
    }
    const auto& keys = channel_.curve().keys().keys;
    const double first_key = keys.front().frame, last_key = keys.back().frame;
    draw_span(c, panel_.first, std::min(first_key, panel_.last), true);
    draw_span(c, std::max(first_key, panel_.first), std::min(last_key, panel_.last), false);
    draw_span(c, std::max(last_key, panel_.first), panel_.last, true);
  }

  // Draws the curve between two frames, exact on both sides of each key in between.
  void draw_span(int c, double from, double to, bool is_outside) {
    if (!(from < to)) return;
    Sampler<D> sampler(channel_.curve());
    const double pixels = panel_.x(to) - panel_.x(from);
    const auto count = static_cast<int>(std::ceil(samples_a_pixel * pixels)) + 1;
    const auto& keys = channel_.curve().keys().keys;
    auto key = std::upper_bound(keys.begin(), keys.end(), from,
                                [](double frame, const Key<D>& k) { return frame < k.frame; });
    Path path;
    // At joints, starts with the value after `from` and ends with the value before `to`.
    path.move_to(panel_.at(from, sampler.value(from)[c]));
    for (int k = 1; k <= count; ++k) {
      if (poll_.after(parts_of_key)) return;
      const double frame = k == count ? to : from + (to - from) * k / count;
      for (; key != keys.end() && key->frame < frame; ++key) {
        if (poll_.after(parts_of_key)) return;
        path.line_to(panel_.at(key->frame, sampler.left_value(key->frame)[c]));
        path.line_to(panel_.at(key->frame, sampler.value(key->frame)[c]));
      }
      path.line_to(
          panel_.at(frame, k == count ? sampler.left_value(frame)[c] : sampler.value(frame)[c]));
    }
    if (!is_outside || to < panel_.last) path.line_to(panel_.at(to, sampler.value(to)[c]));
    add_path(path.take(), c, is_outside);
  }

  void add_path(const std::string& path, int c, bool is_outside) {
    text_ += fmt::format("<path class=\"curve c{}{}\" d=\"{}\"/>\n", colour(c),
                         is_outside ? " outside" : "", path);
  }

  void draw_handles(int c) {
    for (const KeyHandle<D>& handle : handles_) {
      if (poll_.after(parts_of_key)) return;
      if (!is_seen(handle.key_frame)) continue;
      const Point key = panel_.at(handle.key_frame, handle.key_value[c]);
      const Point tip = panel_.at(handle.frame, handle.value[c]);
      text_ += fmt::format("<path class=\"handle\" d=\"M{} {}L{} {}\"/>", coordinate(key.x),
                           coordinate(key.y), coordinate(tip.x), coordinate(tip.y));
      text_ += fmt::format("<circle class=\"tip\" cx=\"{}\" cy=\"{}\" r=\"3\"/>\n",
                           coordinate(tip.x), coordinate(tip.y));
    }
  }

  void draw_keys(int c) {
    if (!channel_.is_animated()) return;
    for (const Key<D>& key : channel_.curve().keys().keys) {
      if (poll_.after(parts_of_key)) return;
      if (!is_seen(key.frame)) continue;
      const Point at = panel_.at(key.frame, key.value[c]);
      text_ +=
          fmt::format("<path class=\"key k{}\" d=\"M{} {}m0 -5.5l5.5 5.5-5.5 5.5-5.5-5.5z\"/>\n",
                      colour(c), coordinate(at.x), coordinate(at.y));
    }
  }

  const Channel<D>& channel_;
  const std::string& path_;
  bool is_switch_;
  Panel panel_;
  StopPoll& poll_;
  std::vector<KeyHandle<D>> handles_;
  std::string text_;
};

}  // namespace

std::string curve_plot(std::span<const NamedChannel> channels, double first, double last,
                       const std::string& title, const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  const double panel = header + panel_height + panel_gap;
  const double height = top_margin + panel * static_cast<double>(channels.size()) + bottom_margin;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"Curves of {2}\">\n",
      coordinate(width), coordinate(height), title);
  text += style;
  text += "<rect class=\"back\" width=\"100%\" height=\"100%\"/>\n";
  text += fmt::format("<text class=\"title\" x=\"{}\" y=\"30\">{}</text>\n",
                      coordinate(left_margin), title);
  text += fmt::format("<text x=\"{}\" y=\"30\" text-anchor=\"end\">frames {:g} to {:g}</text>\n",
                      coordinate(width - right_margin), first, last);
  double top = top_margin;
  for (const NamedChannel& channel : channels) {
    text += std::visit(
        [&]<class C>(const C* held) {
          if constexpr (std::is_same_v<C, Switch>) {
            return ChannelPlot<1>(held->channel(), channel.path, true, first, last, top, poll)
                .draw();
          } else {
            return ChannelPlot(*held, channel.path, false, first, last, top, poll).draw();
          }
        },
        channel.channel);
    top += panel;
  }
  return text + "</svg>\n";
}

}  // namespace pliant::cli
