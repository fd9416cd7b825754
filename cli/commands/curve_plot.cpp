#include "cli/commands/curve_plot.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
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
constexpr double left = 76;
constexpr double right = width - 24;
constexpr double header = 78;  // of the picture, with the name of the first panel
constexpr double panel_height = 190;
constexpr double panel_step = 250;  // from one panel to the next

constexpr std::string_view style = R"(<style>
  text { font: 12px system-ui, sans-serif; fill: #5b6472; } .name { font-weight: 600; fill: #1c2330; }
  .back, .tip { fill: #ffffff; } .panel { fill: #f7f8fa; stroke: #c9d0da; } .end { stroke: #c9d0da; }
  .curve { fill: none; stroke: currentColor; stroke-width: 2; stroke-linejoin: round; }
  .outside { stroke-dasharray: 5 4; opacity: 0.65; } .handle, .tip { stroke: #8a94a3; }
  .key { fill: currentColor; stroke: #ffffff; }
  .c0 { color: #2563c9; } .c1 { color: #c2362f; } .c2 { color: #2a8a4a; }
  @media (prefers-color-scheme: dark) {
    text { fill: #a3adba; } .name { fill: #eef1f5; } .key { stroke: #14171c; }
    .back, .tip { fill: #14171c; } .panel { fill: #1b2027; stroke: #3a424e; } .end { stroke: #3a424e; }
    .c0 { color: #77a8ff; } .c1 { color: #ff8078; } .c2 { color: #6fd48f; }
  }
</style>
)";

constexpr std::string_view diamond = "m0 -5.5l5.5 5.5-5.5 5.5-5.5-5.5z";
constexpr std::size_t parts_of_key = 1024;  // of the work for each, see StopPoll

template <int D>
class ChannelPlot {
 public:
  ChannelPlot(const Channel<D>& channel, bool is_switch, double first, double last, double top,
              StopPoll& poll)
      : channel_(channel),
        is_switch_(is_switch),
        first_(first),
        last_(last),
        top_(top),
        poll_(poll) {
    if (channel.is_animated()) handles_ = channel.curve().handles();
    choose_range();
  }

  std::string draw(const std::string& path) {
    add("<text class=\"name\" x=\"{}\" y=\"{}\">{}</text>\n", left, top_ - 9, path);
    draw_legend();
    add("<rect class=\"panel\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", left, top_,
        right - left, panel_height);
    for (const double value : {low_, high_}) {
      add("<path class=\"end\" d=\"M{} {:.2f}H{}\"/>", left, y(value), right);
      add("<text x=\"{}\" y=\"{:.2f}\" dy=\"4\" text-anchor=\"end\">{}</text>\n", left - 8,
          y(value), label(value));
    }
    add("<text x=\"{}\" y=\"{}\">{:g}</text>", left, top_ + panel_height + 16, first_ + 0.0);
    add("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:g}</text>\n", right,
        top_ + panel_height + 16, last_ + 0.0);
    add("<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">\n",
        left, top_, right - left, panel_height);
    for (int c = 0; c < D; ++c) draw_curve(c);
    for (int c = 0; c < D; ++c) draw_handles(c);
    add("</svg>\n");
    for (int c = 0; c < D; ++c) draw_keys(c);
    return std::move(text_);
  }

 private:
  template <class... Parts>
  void add(fmt::format_string<const Parts&...> format, const Parts&... parts) {
    fmt::format_to(std::back_inserter(text_), format, parts...);
  }

  double x(double frame) const {
    return left + (frame - first_) / (last_ - first_) * (right - left);
  }
  double y(double value) const {
    constexpr double air = 14;  // above the highest and below the lowest value
    const double share = high_ > low_ ? (value - low_) / (high_ - low_) : 0.5;
    const double place = top_ + panel_height - air - share * (panel_height - 2 * air);
    return std::clamp(place, -1e6, 1e6);
  }

  // The curve's exact extrema between its keys. Handles and the curve outside its keys extend them
  // by at most the curve's height on each side, so that they do not flatten it.
  void choose_range() {
    if (!channel_.is_animated()) {
      const Value<D> value = channel_.at(first_);
      low_ = *std::min_element(value.begin(), value.end());
      high_ = *std::max_element(value.begin(), value.end());
      return;
    }
    const auto extent = [&](double from, double to) {
      const auto range = channel_.curve().range(from, to);
      return std::pair(*std::min_element(range.low.begin(), range.low.end()),
                       *std::max_element(range.high.begin(), range.high.end()));
    };
    const auto& keys = channel_.curve().keys().keys;
    std::tie(low_, high_) = extent(std::clamp(keys.front().frame, first_, last_),
                                   std::clamp(keys.back().frame, first_, last_));
    auto [lowest, highest] = extent(first_, last_);
    for (const KeyHandle<D>& handle : handles_) {
      if (!is_seen(handle.frame)) continue;
      for (const double value : handle.value) {
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
      }
    }
    const double room = high_ > low_ ? high_ - low_ : std::numeric_limits<double>::infinity();
    constexpr double largest = 1e300;
    low_ = std::clamp(std::max(low_ - room, lowest), -largest, largest);
    high_ = std::clamp(std::min(high_ + room, highest), -largest, largest);
  }

  bool is_seen(double frame) const { return frame >= first_ && frame <= last_; }

  // One component has the first colour, three have x, y, z in red, green and blue.
  static int colour(int component) { return D == 1 ? 0 : (component + 1) % 3; }

  std::string label(double value) const {
    if (is_switch_) return value == 0 ? "false" : "true";
    const bool is_rounded = std::abs(value) < 1e-9 * (high_ - low_);  // zero but for rounding
    return fmt::format("{:.5g}", is_rounded ? 0.0 : value + 0.0);     // not -0
  }

  void draw_legend() {
    double place = right;
    const auto entry = [&](std::string_view name, int colour, std::string_view mark) {
      place -= 8.0 * static_cast<double>(name.size()) + 26;
      add("<g class=\"c{}\" transform=\"translate({} {})\">{}<text x=\"20\" "
          "y=\"4\">{}</text></g>\n",
          colour, place, top_ - 13, mark, name);
    };
    if (!handles_.empty()) {
      entry("handle", 0,
            "<path class=\"handle\" d=\"M0 0H11\"/><circle class=\"tip\" cx=\"12\" r=\"3\"/>");
    }
    if (channel_.is_animated())
      entry("key", 0, fmt::format("<path class=\"key\" d=\"M8 0{}\"/>", diamond));
    for (int c = D - 1; D > 1 && c >= 0; --c) {
      entry(std::string_view("xyz").substr(static_cast<std::size_t>(c), 1), colour(c),
            "<path class=\"curve\" d=\"M0 0H14\"/>");
    }
  }

  void draw_curve(int c) {
    if (!channel_.is_animated()) {
      add("<path class=\"curve c{}\" d=\"M{} {:.1f}H{}\"/>\n", colour(c), left,
          y(channel_.at(first_)[c]), right);
      return;
    }
    const auto& keys = channel_.curve().keys().keys;
    const double from = std::clamp(keys.front().frame, first_, last_);
    const double to = std::clamp(keys.back().frame, first_, last_);
    draw_span(c, first_, from, true);
    draw_span(c, from, to, false);
    draw_span(c, to, last_, true);
  }

  // Draws the curve between two frames, a point a pixel, exact on both sides of each key.
  void draw_span(int c, double from, double to, bool is_outside) {
    if (!(from < to)) return;
    Sampler<D> sampler(channel_.curve());
    std::vector<double> frames;
    const int count = static_cast<int>(std::ceil(x(to) - x(from))) + 1;
    for (int k = 1; k < count; ++k) frames.push_back(from + (to - from) * k / count);
    for (const Key<D>& key : channel_.curve().keys().keys)
      if (key.frame > from && key.frame < to) frames.push_back(key.frame);
    std::sort(frames.begin(), frames.end());
    frames.push_back(to);
    double start_x = x(from), start_y = y(sampler.value(from)[c]);
    add("<path class=\"curve c{}{}\" d=\"M{:.1f} {:.1f}", colour(c), is_outside ? " outside" : "",
        start_x, start_y);
    // The slopes of lines from the start that pass all points since within a twentieth of a pixel.
    constexpr double infinity = std::numeric_limits<double>::infinity();
    double least = -infinity, most = infinity, end_x = start_x, end_y = start_y;
    const auto line_to_end = [&] {
      if (end_x != start_x || end_y != start_y) add("L{:.1f} {:.1f}", end_x, end_y);
      start_x = end_x, start_y = end_y, least = -infinity, most = infinity;
    };
    const auto pass = [&](double to_x, double to_y) {
      const auto slope = [&](double at_y) { return (at_y - start_y) / (to_x - start_x); };
      if (!(slope(to_y) >= least && slope(to_y) <= most)) line_to_end();
      end_x = to_x, end_y = to_y;
      if (to_x <= start_x) return line_to_end();
      least = std::max(least, slope(to_y - 0.05)), most = std::min(most, slope(to_y + 0.05));
    };
    for (const double frame : frames) {
      if (poll_.after(parts_of_key)) return;
      pass(x(frame), y(sampler.left_value(frame)[c]));
      pass(x(frame), y(sampler.value(frame)[c]));
    }
    line_to_end();
    add("\"/>\n");
  }

  void draw_handles(int c) {
    for (const KeyHandle<D>& handle : handles_) {
      if (poll_.after(parts_of_key)) return;
      if (!is_seen(handle.key_frame)) continue;
      const double tip_x = x(handle.frame), tip_y = y(handle.value[c]);
      add("<path class=\"handle\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>", x(handle.key_frame),
          y(handle.key_value[c]), tip_x, tip_y);
      add("<circle class=\"tip\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", tip_x, tip_y);
    }
  }

  void draw_keys(int c) {
    if (!channel_.is_animated()) return;
    for (const Key<D>& key : channel_.curve().keys().keys) {
      if (poll_.after(parts_of_key)) return;
      if (!is_seen(key.frame)) continue;
      add("<path class=\"key c{}\" d=\"M{:.1f} {:.1f}{}\"/>\n", colour(c), x(key.frame),
          y(key.value[c]), diamond);
    }
  }

  const Channel<D>& channel_;
  const bool is_switch_;
  const double first_, last_;  // frames
  const double top_;           // of the plotted area [px]
  double low_ = 0, high_ = 0;  // values
  StopPoll& poll_;
  std::vector<KeyHandle<D>> handles_;
  std::string text_;
};

}  // namespace

std::string curve_plot(std::span<const NamedChannel> channels, double first, double last,
                       const std::string& title, const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  const double height = header - 14 + panel_step * static_cast<double>(channels.size());
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"Curves of {2}\">\n{3}"
      "<rect class=\"back\" width=\"100%\" height=\"100%\"/>\n"
      "<text class=\"name\" x=\"{4}\" y=\"30\">{2}</text>\n"
      "<text x=\"{5}\" y=\"30\" text-anchor=\"end\">frames {6:g} to {7:g}</text>\n",
      width, height, title, style, left, right, first, last);
  double top = header;
  for (const NamedChannel& channel : channels) {
    const auto plot = [&]<int D>(const Channel<D>& held, bool is_switch) {
      return ChannelPlot<D>(held, is_switch, first, last, top, poll).draw(channel.path);
    };
    text += std::visit(
        [&]<class C>(const C* held) {
          if constexpr (std::is_same_v<C, Switch>)
            return plot(held->channel(), true);
          else
            return plot(*held, false);
        },
        channel.channel);
    top += panel_step;
  }
  return text + "</svg>\n";
}

}  // namespace pliant::cli
