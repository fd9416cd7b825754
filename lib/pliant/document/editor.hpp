#pragma once

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/document/draft.hpp"
#include "pliant/document/keyed_curve.hpp"
#include "pliant/document/operation.hpp"
#include "pliant/scene/format/format.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::edit {

/// The place of an attribute in a draft, whether it is given there or not.
struct Spot {
  std::string path;                          ///< without a component
  ElementIndex object = 0;                   ///< the surface, force, group or scene
  std::optional<ElementIndex> element = {};  ///< that may have the attribute; null: it is absent
  std::string part = {};                     ///< the name of that element
  AttributeFormat format = {};
  std::optional<std::size_t> component = {};

  std::string_view attribute() const { return format.name; }
};

/// Makes operations on a draft. Each commits its changes, or returns an error, after which the
/// draft must not be used.
class Editor {
 public:
  /// `scene`: that of the draft's text before the first operation. `parse`: makes that of a text.
  Editor(Draft& draft, const Scene& scene, ParseScene parse,
         const std::vector<ElementFormat>& formats = scene_format());

  Result<void> apply(const Operation& operation);

  /// Of what was changed: `NAME.attribute`, or `NAME` for what was added, moved or deleted.
  const std::set<std::string>& parts() const { return parts_; }

 private:
  // Values: edit_values.cpp.
  Result<void> operator()(const Set& set);
  Result<void> operator()(const Reset& reset);
  Result<void> operator()(const Animate& animate);
  Result<void> operator()(const Freeze& freeze);
  Result<void> operator()(const SetPart& set);

  // Keys: edit_keys.cpp, and those that make curves anew: edit_curves.cpp.
  Result<void> operator()(const SetKey& set);
  Result<void> operator()(const DeleteKeys& deletion);
  Result<void> operator()(const MoveKeys& move);
  Result<void> operator()(const ScaleKeys& scale);
  Result<void> operator()(const SetTangent& set);
  Result<void> operator()(const SetHandle& set);
  Result<void> operator()(const SetInterpolation& set);
  Result<void> operator()(const SetExtrapolation& set);
  Result<void> operator()(const BakeKeys& bake);
  Result<void> operator()(const SimplifyKeys& simplification);
  Result<void> operator()(const Scale& scale);
  Result<void> operator()(const SetCurve& set);
  Result<void> operator()(const Splice& splice);

  // Objects: edit_objects.cpp and edit_groups.cpp.
  Result<void> operator()(const Add& addition);
  Result<void> operator()(const Duplicate& duplication);
  Result<void> operator()(const Delete& deletion);
  Result<void> operator()(const Rename& rename);
  Result<void> operator()(const Target& target);
  Result<void> operator()(const Group& group);
  Result<void> operator()(const Ungroup& ungroup);

  // Finding things: editor.cpp.
  using NamedElement = std::pair<std::string, ElementIndex>;
  std::vector<NamedElement> objects() const;
  struct Reference {
    std::string path;  // of an attribute that names surfaces
    ElementIndex object = 0;
    ElementIndex element = 0;  // of the object, or a part of it
    const AttributeFormat* format = nullptr;
  };
  std::vector<Reference> references() const;
  Result<ElementIndex> object(std::string_view name) const;
  Result<void> check_new(const std::string& name) const;
  bool is_force(std::string_view element) const;
  bool is_force(ElementIndex element) const;
  std::string name_of(ElementIndex element) const;
  std::string free_name(const std::string& like, std::set<std::string>& taken) const;
  std::set<std::string> taken_names() const;
  const ElementFormat& format_of(std::string_view element) const;
  const AttributeFormat* find_attribute(std::string_view element, std::string_view name) const;
  std::vector<std::string> parts_of(ElementIndex object) const;
  Result<Spot> spot(const std::string& path) const;
  Result<Spot> spot_on_path(const std::string& path, ElementIndex object,
                            const std::string& position, const std::string& attribute) const;

  /// The <animate>, <falloff> or <path> of an attribute.
  std::optional<ElementIndex> animated(const Spot& spot) const;
  std::optional<ElementIndex> on_path(const Spot& spot) const;
  /// The constant text of an attribute, or its default. Errors: it is animated; it has none.
  Result<std::string> constant(const Spot& spot) const;

  Result<void> set_constant(const Spot& spot, const std::string& value);
  Result<void> insert_part(const Spot& spot, const xml::ElementText& part);
  Result<void> insert_animate(const Spot& spot, double frame, const std::string& value);
  Result<void> insert_animate(const Spot& spot, const xml::ElementText& animate);
  Result<std::string> with_component(const Spot& spot, const std::string& value) const;
  Result<std::string> value_at(const Spot& spot, double frame) const;

  // Curves.
  Result<AnyCurve> curve_of(const Spot& spot) const;
  Result<AnyCurve> curve_of(const std::string& channel) const;
  /// Calls `change(curve, spot)` for the curve of each channel.
  template <class Change>
  Result<void> for_each_curve(const std::vector<std::string>& channels, const Change& change);
  /// Calls `change(curve, indices of its keys, spot)` for the keys of each channel.
  template <class Change>
  Result<void> for_each_keys(const std::vector<KeysOf>& keys, const Change& change);
  template <int D>
  Result<void> write_curve(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted);
  template <int D>
  Result<void> write_curve(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted,
                           const std::vector<KeyEntry<D>>& keys);
  template <int D>
  void write_animate(KeyedCurve<D>& curve, const CurveKeys<D>& wanted,
                     const std::vector<KeyEntry<D>>& keys);
  template <int D>
  Result<void> write_loop(const KeyedCurve<D>& curve, const std::optional<Loop<D>>& wanted);
  bool is_inherited(ElementIndex key, Side side) const;
  template <int D>
  Result<void> write_keys(const KeyedCurve<D>& curve, const std::vector<KeyEntry<D>>& wanted);
  template <int D>
  void write_key(const KeyedCurve<D>& curve, std::size_t key, const KeyEntry<D>& wanted);
  template <int D>
  void write_sides(const KeyedCurve<D>& curve, std::size_t key, const Key<D>& wanted);
  template <int D>
  Result<void> set_key(const KeyedCurve<D>& curve, const SetKey& set);
  template <int D>
  Result<Value<D>> of_components(const KeyedCurve<D>& curve, std::string_view name,
                                 const std::vector<double>& numbers, double absent) const;
  template <int D>
  Result<void> write_moved(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted,
                           const std::vector<std::size_t>& moved, Collision collision);
  void set_side(ElementIndex key, Side side, std::string_view name, const std::string& value);
  void set_or_remove(ElementIndex element, std::string_view name, const std::string& value);
  void rewrite(ElementIndex element, std::string_view name, const std::string& value);
  Result<void> commit_rewritten(const std::string& channel);
  Result<void> scale_constant(const Spot& spot, const Scale& scale);
  template <int D>
  Result<Curve<D>> curve_for(const Spot& spot, const CurveKeys<D>& keys) const;
  template <int D>
  Result<void> set_curve(const Spot& spot, const CurveKeys<D>& keys);
  template <int D>
  Result<void> splice(const Spot& spot, const Splice& splice, const CurveKeys<D>& keys);

  // Objects.
  Result<ElementIndex> force(std::string_view name) const;
  Result<void> move_into(const std::string& force, const std::string& group);
  Result<void> move_behind(const std::string& force, const std::string& other);
  Result<void> ungroup(const std::string& group);
  Result<void> inherit(const std::string& group, const std::string& force);
  Result<void> inherit_targets(ElementIndex group, ElementIndex force);

  Draft& draft_;
  const Scene& scene_;
  ParseScene parse_;
  const std::vector<ElementFormat>& formats_;
  std::set<std::string> parts_;
  bool replaces_computed_ = false;  // whether numbers may take the place of values with `$`
  std::string computed_;            // an attribute with `$` that had to be rewritten; empty: none
};

}  // namespace pliant::edit
