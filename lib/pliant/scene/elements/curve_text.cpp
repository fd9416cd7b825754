#include "pliant/scene/elements/curve_text.hpp"

#include <optional>

namespace pliant::xml {
namespace {

bool is_easing(const Interpolation& interpolation, Ease ease) {
  return interpolation.kind == Interpolation::Kind::Easing && interpolation.ease == ease;
}

/// What one side of a key says, but for its tangent.
template <int D>
void add_side(const Tangent<D>& side, std::optional<double>& length,
              std::optional<Handle<D>>& handle) {
  if (side.kind == Tangent<D>::Kind::Handle)
    handle = Handle<D>{side.handle_frames, side.handle_value};
  else
    length = side.length;
}

}  // namespace

std::string with_doubled_dollars(std::string_view text) {
  std::string doubled;
  for (const char c : text) doubled.append(c == '$' ? 2 : 1, c);
  return doubled;
}

void add_attributes(ElementText& element, const Table& table, const Table& standard) {
  for (std::size_t k = 0; k < table.size(); ++k) {
    const Attribute& attribute = table[k].attribute;
    const std::string& text = table[k].text;
    const bool is_needed = attribute.need == Need::Required || text != standard[k].text;
    if (is_needed && !text.empty())
      element.attributes.emplace_back(attribute.name, with_doubled_dollars(text));
  }
}

template <int D>
Tangent<D> plain(const Tangent<D>& tangent) {
  using Kind = typename Tangent<D>::Kind;
  if (tangent.kind == Kind::Handle)
    return {.kind = Kind::Handle,
            .handle_frames = tangent.handle_frames,
            .handle_value = tangent.handle_value};
  Tangent<D> result{.kind = tangent.kind, .length = tangent.length};
  if (tangent.kind == Kind::Slope) result.slope = tangent.slope;
  return result;
}

bool has_same_word(const Interpolation& a, const Interpolation& b) {
  if (a.kind != b.kind) return false;
  return a.kind != Interpolation::Kind::Easing || (a.ease == b.ease && a.side == b.side);
}

template <int D>
KeyText<D> text_of_key(const Key<D>& key, const AnimateText<D>& defaults) {
  using Kind = typename Tangent<D>::Kind;
  KeyText<D> text{.frame = key.frame, .value = key.value, .left = key.left};
  if (!has_same_word(key.next, defaults.interpolation)) text.interpolation = key.next;
  if (is_easing(key.next, Ease::Elastic)) {
    text.amplitude = key.next.amplitude;
    text.period = key.next.period;
  }
  if (is_easing(key.next, Ease::Back)) text.back = key.next.back;
  if (key.next.kind == Interpolation::Kind::CubicBezier) text.control = key.next.control;

  add_side(key.in, text.in_length, text.in_handle);
  add_side(key.out, text.out_length, text.out_handle);
  const auto without_length = [](Tangent<D> tangent) {
    tangent.length.reset();
    return plain(tangent);
  };
  const Tangent<D> in = without_length(key.in);
  const Tangent<D> out = without_length(key.out);
  const Tangent<D> standard = without_length(defaults.tangent);
  if (in == out && in.kind != Kind::Handle) {
    if (in != standard) text.tangent = in;
    return text;
  }
  if (in.kind != Kind::Handle && in != standard) text.in = in;
  if (out.kind != Kind::Handle && out != standard) text.out = out;
  return text;
}

template <int D>
ElementText key_element(const Key<D>& key, const AnimateText<D>& defaults, KeyAxis axis,
                        ValueKind kind) {
  KeyText<D> text = text_of_key(key, defaults);
  KeyText<D> standard;
  ElementText element{"key"};
  add_attributes(element, table_of(text, axis, kind), table_of(standard, axis, kind));
  return element;
}

template <int D>
ElementText loop_element(const Loop<D>& loop, ValueKind kind) {
  Loop<D> own = loop;
  Loop<D> standard;
  ElementText element{"loop"};
  add_attributes(element, table_of(own, kind), table_of(standard, kind));
  return element;
}

template <int D>
ElementText curve_element(std::string_view attribute, const CurveKeys<D>& keys, ValueKind kind,
                          const StopRequest& should_stop) {
  const KeyAxis axis = attribute.empty() ? KeyAxis::Falloff : KeyAxis::Frame;
  AnimateText<D> text{.before = keys.before, .after = keys.after, .overshoot = keys.overshoot};
  AnimateText<D> standard;
  ElementText element{axis == KeyAxis::Frame ? "animate" : "falloff"};
  if (axis == KeyAxis::Frame) element.attributes.emplace_back("attribute", attribute);
  add_attributes(element, table_of(text, axis, kind), table_of(standard, axis, kind));
  // A boolean channel's keys step unless they say otherwise.
  if (kind == ValueKind::Boolean) standard.interpolation.kind = Interpolation::Kind::Step;
  for (const Key<D>& key : keys.keys) {
    if (is_stopped(should_stop, element.children.size())) break;
    element.children.push_back(key_element(key, standard, axis, kind));
  }
  if (keys.loop) element.children.push_back(loop_element(*keys.loop, kind));
  return element;
}

template Tangent<1> plain(const Tangent<1>&);
template Tangent<3> plain(const Tangent<3>&);
template KeyText<1> text_of_key(const Key<1>&, const AnimateText<1>&);
template KeyText<3> text_of_key(const Key<3>&, const AnimateText<3>&);
template ElementText key_element(const Key<1>&, const AnimateText<1>&, KeyAxis, ValueKind);
template ElementText key_element(const Key<3>&, const AnimateText<3>&, KeyAxis, ValueKind);
template ElementText loop_element(const Loop<1>&, ValueKind);
template ElementText loop_element(const Loop<3>&, ValueKind);
template ElementText curve_element(std::string_view, const CurveKeys<1>&, ValueKind,
                                   const StopRequest&);
template ElementText curve_element(std::string_view, const CurveKeys<3>&, ValueKind,
                                   const StopRequest&);

}  // namespace pliant::xml
