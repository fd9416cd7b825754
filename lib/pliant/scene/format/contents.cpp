#include "pliant/scene/format/contents.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <variant>

#include <fmt/format.h>

namespace pliant::xml {
namespace {

template <class Kind>
Force standard() {
  Force force;
  force.kind = Kind{};
  if constexpr (requires { Description<Kind>::magnitude; })
    force.magnitude = Description<Kind>::magnitude;
  return force;
}

/// One force of each kind of the variant.
template <class... Kinds>
std::vector<Force> standards(const std::variant<Kinds...>&) {
  return {standard<Kinds>()...};
}

/// A way to give a surface a shape, and to find whether it has that.
struct Shape {
  std::string_view name;
  bool (*is_of)(const Surface& surface);
  void (*give)(Surface& surface);  // with default values
  Contents (*contents)(Surface& surface);
};

template <template <class> class Element, class Kind, bool is_cage = false>
Shape shape() {
  return {Description<Element<Surface>>::element,
          [](const Surface& surface) {
            return std::holds_alternative<Kind>(surface.shape) &&
                   surface.subdivision.has_value() == is_cage;
          },
          [](Surface& surface) {
            surface.shape = Kind{};
            if (is_cage)
              surface.subdivision.emplace();
            else
              surface.subdivision.reset();
          },
          [](Surface& surface) { return contents_of(Element<Surface>{surface}); }};
}

const std::array<Shape, 4>& shapes() {
  static const std::array all = {shape<SheetOf, GridSheet>(), shape<MeshOf, MeshFile>(),
                                 shape<NetOf, NurbsNet>(), shape<CageOf, MeshFile, true>()};
  return all;
}

/// The kind of that name.
const Force& force_of(std::string_view kind) {
  static const std::vector<Force> kinds = force_kinds();
  return *std::ranges::find(kinds, kind, kind_of);
}

std::vector<std::string_view> force_names() {
  std::vector<std::string_view> names;
  for (const Force& kind : force_kinds()) names.push_back(kind_of(kind));
  return names;
}

Contents add_force(Scene& scene, std::string_view kind, const std::string& group) {
  Force& force = scene.forces.emplace_back(force_of(kind));
  force.group = group;
  return contents_of(force);
}

}  // namespace

std::vector<Slot*> Contents::channels() {
  std::vector<Slot*> slots;
  const auto add = [&](Table& table) {
    for (Slot& slot : table) slots.push_back(&slot);
  };
  add(attributes);
  for (ChildPlace& child : children)
    if (child.part) add(child.part->attributes);
  return slots;
}

bool Contents::has_channels() {
  return std::ranges::any_of(channels(), [](const Slot* slot) { return is_channel(slot->place); });
}

bool Contents::has_positions() const {
  return std::ranges::any_of(attributes, [](const Slot& slot) {
    return std::holds_alternative<PositionChannel*>(slot.place);
  });
}

Contents contents_of(Surface& surface) {
  Contents made = contents_of<Surface&>(surface);
  made.driver = &surface.driven_by;
  return made;
}

Contents contents_of(Force& force) {
  Contents made = std::visit(
      []<class Kind>(const Kind&) { return empty_contents<Description<Kind>>(); }, force.kind);
  made.may_include = true;
  SlotMaker maker;
  describe(maker, force);
  std::visit(
      [&]<class Kind>(Kind& kind) {
        Description<Force>::rows_of<Kind>(maker, force);
        describe(maker, kind);
      },
      force.kind);
  made.attributes = maker.take();
  Description<Force>::children(ContentsMaker(made), force);
  if (!force.group.empty())
    find(made.attributes, deformation_radius_attribute.name)->excluded =
        "a force in a <group> must not have one; the deformationRadius of the group selects the "
        "region";
  return made;
}

Contents contents_of(ClosedMesh& mesh) {
  Contents made = empty_contents<Description<ClosedMesh>>();
  auto reading = std::make_shared<MeshReading>();
  SlotMaker maker;
  describe(maker, mesh.mesh);
  describe(maker, *reading);
  describe(maker, mesh.cache);
  made.attributes = maker.take();
  made.unused = std::move(reading);
  for (Slot& slot : made.attributes) {
    if (std::ranges::count(Description<ClosedMesh>::words, slot.attribute.name) == 0)
      slot.excluded =
          "that is of a surface's mesh; the mesh of a collider has file, object, cache and "
          "cacheStart";
  }
  return made;
}

Contents contents_of(PointsOf of) {
  Contents made = empty_contents<Description<PointsOf>>();
  made.numbers = [&net = of.net] {
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> rows = net.points;
    return std::vector<double>(rows.data(), rows.data() + rows.size());
  };
  made.take_numbers = [&net = of.net](const std::vector<double>& numbers) -> Checked<void> {
    if (numbers.size() % 3 != 0)
      return refused(fmt::format("has {} numbers; each point has three", numbers.size()));
    net.points = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
        numbers.data(), static_cast<Eigen::Index>(numbers.size() / 3), 3);
    return {};
  };
  return made;
}

Contents contents_of(WeightsOf of) {
  Contents made = empty_contents<Description<WeightsOf>>();
  made.numbers = [&net = of.net] { return net.weights; };
  made.take_numbers = [&net = of.net](std::vector<double> numbers) -> Checked<void> {
    net.weights = std::move(numbers);
    return {};
  };
  return made;
}

Contents contents_of(NetOf<Surface> of) {
  using Of = Description<NetOf<Surface>>;
  Contents made = empty_contents<Of>();
  made.attributes = table_of(of);
  NurbsNet& net = std::get<NurbsNet>(of.surface.shape);
  constexpr Attribute wrap{.name = "wrap",
                           .meaning =
                               "the closed directions: the first column (row) follows the "
                               "last one",
                           .words = wrap_words};
  const auto read = [&net, wrap](std::string_view text) {
    Wrap value = Wrap::None;
    Checked<void> read_word = slot(wrap, choice(value)).read(text);
    net.u.is_closed = closes_u(value);
    net.v.is_closed = closes_v(value);
    return read_word;
  };
  Wrap value = wrap_of(net.u.is_closed, net.v.is_closed);
  Slot own = slot(wrap, choice(value));
  made.attributes.push_back(custom(wrap, own.type, own.range, read, own.text));
  Of::children(ContentsMaker(made), of);
  return made;
}

std::string_view shape_of(const Surface& surface) {
  const auto found =
      std::ranges::find_if(shapes(), [&](const Shape& one) { return one.is_of(surface); });
  return found != shapes().end() ? found->name : std::string_view();
}

Kinds kinds_of(const ShapeOf<Surface>& of) {
  Surface& surface = of.surface;
  Kinds kinds{.names = {},
              .add =
                  [&surface](std::string_view name) {
                    const Shape& one = *std::ranges::find(shapes(), name, &Shape::name);
                    one.give(surface);
                    return one.contents(surface);
                  },
              .for_each =
                  [&surface](const auto& visit) {
                    for (const Shape& one : shapes()) {
                      if (!one.is_of(surface)) continue;
                      Contents contents = one.contents(surface);
                      visit(contents);
                    }
                  }};
  for (const Shape& one : shapes()) kinds.names.push_back(one.name);
  return kinds;
}

Kinds kinds_of(const SolidOf<Collider>& of) {
  Collider& collider = of.collider;
  const auto contents = [&collider] {
    return std::visit([](auto& shape) { return contents_of(shape); }, collider.shape);
  };
  Kinds kinds{.names = {},
              .add =
                  [&collider, contents](std::string_view name) {
                    const std::vector<Collider> all = solid_kinds();
                    collider.shape = std::ranges::find(all, name, [](const Collider& one) {
                                       return pliant::shape_of(one);
                                     })->shape;
                    return contents();
                  },
              .for_each =
                  [contents](const auto& visit) {
                    Contents of_shape = contents();
                    visit(of_shape);
                  }};
  for (const Collider& one : solid_kinds()) kinds.names.push_back(pliant::shape_of(one));
  return kinds;
}

Kinds kinds_of(const KnotsOf& of) {
  NurbsNet& net = of.net;
  const auto contents = [&net](Along along, bool is_new) {
    auto knots = std::make_shared<Knots>();
    if (!is_new) knots->along = along;
    Contents made = contents_of(*knots);
    made.numbers = [&net, along] { return (along == Along::U ? net.u : net.v).knots; };
    made.take_numbers = [&net, knots](std::vector<double> numbers) -> Checked<void> {
      (knots->along == Along::U ? net.u : net.v).knots = std::move(numbers);
      return {};
    };
    return made;
  };
  return {.names = {Description<Knots>::element},
          .add = [contents](std::string_view) { return contents(Along::U, true); },
          .drop = [] {},
          .for_each =
              [&net, contents](const auto& visit) {
                for (const Along along : {Along::U, Along::V}) {
                  if ((along == Along::U ? net.u : net.v).knots.empty()) continue;
                  Contents made = contents(along, false);
                  visit(made);
                }
              }};
}

Kinds kinds_of(const ActingIn<Scene>& of) {
  Scene& scene = of.scene;
  Kinds kinds{
      .names = force_names(),
      .add =
          [&scene](std::string_view name) {
            if (name != Description<Group>::element) return add_force(scene, name, "");
            scene.groups.emplace_back();
            return contents_of(GroupIn<Scene>{scene, scene.groups.size() - 1, scene.forces.size()});
          },
      .for_each =
          [&scene](const auto& visit) {
            std::size_t group = 0, force = 0;
            const auto visit_group = [&] {
              Contents contents = contents_of(GroupIn<Scene>{scene, group++, force});
              visit(contents);
            };
            while (force < scene.forces.size()) {
              if (scene.forces[force].group.empty()) {
                Contents contents = contents_of(scene.forces[force++]);
                visit(contents);
                continue;
              }
              const std::string& name = scene.forces[force].group;
              while (scene.groups[group].name != name) visit_group();
              visit_group();
              while (force < scene.forces.size() && scene.forces[force].group == name) ++force;
            }
            while (group < scene.groups.size()) visit_group();
          }};
  kinds.names.push_back(Description<Group>::element);
  return kinds;
}

Kinds kinds_of(const MembersOf<Scene>& of) {
  return {.names = force_names(),
          .add =
              [of](std::string_view name) {
                return add_force(of.scene, name, of.scene.groups[of.group].name);
              },
          .for_each =
              [of](const auto& visit) {
                std::vector<Force>& forces = of.scene.forces;
                const std::string& name = of.scene.groups[of.group].name;
                for (std::size_t k = of.first; k < forces.size() && forces[k].group == name; ++k) {
                  Contents contents = contents_of(forces[k]);
                  visit(contents);
                }
              }};
}

std::vector<Collider> solid_kinds() {
  const auto all = []<class... Kinds>(const std::variant<Kinds...>&) {
    std::vector<Collider> colliders(sizeof...(Kinds));
    std::size_t k = 0;
    (static_cast<void>(colliders[k++].shape = Kinds{}), ...);
    return colliders;
  };
  return all(Collider().shape);
}

std::vector<Force> force_kinds() {
  std::vector<Force> kinds = standards(Force().kind);
  std::erase_if(kinds,
                [](const Force& force) { return std::holds_alternative<CustomForce>(force.kind); });
  return kinds;
}

}  // namespace pliant::xml
