#include "pliant/document/operation_json.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <cxxabi.h>
#include <nlohmann/json.hpp>

#include "document/random_operation.hpp"
#include "pliant/document/document.hpp"
#include "pliant/document/operation_rows.hpp"
#include "support/catch.hpp"
#include "support/random_scene.hpp"
#include "support/sanitized.hpp"

namespace pliant::testing {
namespace {

/// The number of members of an aggregate.
struct AnyMember {
  template <class T>
  operator T() const {
    return T();
  }
};
template <class T, class... Each>
constexpr std::size_t member_count() {
  if constexpr (requires { T{Each{}..., AnyMember{}}; })
    return member_count<T, Each..., AnyMember>();
  else
    return sizeof...(Each);
}

template <class T>
std::size_t row_count() {
  std::size_t count = 0;
  const T thing{};
  describe([&](const Attribute&, const auto&) { ++count; }, thing);
  return count;
}

TEST_CASE("each operation has a row for each of its members", "[document][json]") {
  static_assert(member_count<edit::SetKey>() == 3);
  static_assert(member_count<edit::SetInterpolation>() == 6);
  std::set<std::string_view> names;
  for_each_operation([&]<class Of>(std::type_identity<Of>) {
    CAPTURE(Description<Of>::name);
    CHECK(row_count<Of>() == member_count<Of>());
    // The name of the struct in camelCase.
    const std::unique_ptr<char, decltype(&std::free)> full(
        abi::__cxa_demangle(typeid(Of).name(), nullptr, nullptr, nullptr), &std::free);
    std::string name = full.get();
    name = name.substr(name.rfind(':') + 1);
    name[0] = static_cast<char>(std::tolower(name[0]));
    CHECK(Description<Of>::name == name);
    CHECK(names.insert(Description<Of>::name).second);
  });
  CHECK(names.size() == std::variant_size_v<Operation>);
  CHECK(row_count<edit::KeysOf>() == member_count<edit::KeysOf>());
}

template <class T>
bool is_same(const T& a, const T& b) {
  if constexpr (requires { sizeof(Description<T>); }) {
    bool is_so = true;
    describe([&](const Attribute&, const auto& one,
                 const auto& other) { is_so = is_so && is_same(one, other); },
             a, b);
    return is_so;
  } else if constexpr (std::is_same_v<T, std::vector<edit::KeysOf>>) {
    return std::ranges::equal(a, b, [](const auto& x, const auto& y) { return is_same(x, y); });
  } else {
    return a == b;
  }
}

bool is_same_operation(const Operation& a, const Operation& b) {
  return a.index() == b.index() &&
         std::visit([&]<class Of>(const Of& of) { return is_same(of, std::get<Of>(b)); }, a);
}

TEST_CASE("any operation is the same after JSON", "[document][json][random]") {
  std::map<std::size_t, int> same;
  int refused = 0;
  for (int seed = 0; seed < rounds(60); ++seed) {
    Chance chance(seed);
    auto document = SceneDocument::from_text(RandomScene(seed).text(), "random.xml", "").value();
    for (int k = 0; k < 60; ++k) {
      const Operation operation = RandomOperation(document.scene(), chance).make();
      CAPTURE(seed, k, described(operation));
      const auto json = to_json({operation});
      if (!json) {
        ++refused;
        REQUIRE_THAT(json.error().message, contains_text("operations[0]: "));
        // JSON has all that can be done.
        const auto change = document.apply({operation});
        REQUIRE_FALSE(change);
        continue;
      }
      CAPTURE(*json);
      const auto read = parse_operations(*json);
      if (!read) FAIL(read.error().message);
      REQUIRE(read->size() == 1);
      REQUIRE(is_same_operation(operation, read->front()));
      REQUIRE(to_json(*read).value() == *json);
      ++same[operation.index()];
      if (k % 8 != 0) continue;
      SceneDocument other = document;
      const auto change = document.apply({operation});
      REQUIRE(other.apply(*read).has_value() == change.has_value());
      REQUIRE(other.text() == document.text());
    }
  }
  for (std::size_t kind = 0; kind < std::variant_size_v<Operation>; ++kind) {
    CAPTURE(kind);
    if (rounds(60) >= 60) CHECK(same[kind] > 5);
  }
  CHECK(refused > 0);
}

std::string json_of(const Operation& operation) { return to_json({operation}).value(); }

TEST_CASE("operations are written as people would", "[document][json]") {
  CHECK(json_of(edit::SetKey{"poke.magnitude", 12, "8000"}) ==
        R"([{"op":"setKey","channel":"poke.magnitude","frame":12,"value":"8000"}])");
  CHECK(json_of(edit::SetKey{"poke.magnitude", 1.5}) ==
        R"([{"op":"setKey","channel":"poke.magnitude","frame":1.5}])");
  CHECK(json_of(edit::MoveKeys{{{"a.b", {1, -0.0}}, {"c.d", {}}}, 2, {1e300}}) ==
        R"([{"op":"moveKeys","keys":[{"channel":"a.b","frames":[1,-0.0]},)"
        R"({"channel":"c.d","frames":[]}],"frames":2,"rise":[1e+300]}])");
  CHECK(json_of(edit::ScaleKeys{{{"a.b", {1}}}, 2, 0.5, {}, {-1, 0, 1}, 1}) ==
        R"([{"op":"scaleKeys","keys":[{"channel":"a.b","frames":[1]}],"frame":2,"timeFactor":0.5,)"
        R"("valueFactor":[-1,0,1],"step":1}])");
  CHECK(json_of(edit::SetTangent{{}, edit::Side::In, "flat"}) ==
        R"([{"op":"setTangent","keys":[],"side":"in","tangent":"flat"}])");
  CHECK(json_of(edit::Add{"point", "p", {{"magnitude", "1"}, {"center", "0 0 0"}}}) ==
        R"([{"op":"add","kind":"point","name":"p","attributes":[)"
        R"({"attribute":"magnitude","value":"1"},{"attribute":"center","value":"0 0 0"}]}])");
  CurveKeys<1> curve;
  curve.keys = {{.frame = 1, .value = {2}}, {.frame = 4, .value = {3}}};
  CHECK(json_of(edit::Splice{"poke.magnitude", 1, 5, curve}) ==
        R"([{"op":"splice","channel":"poke.magnitude","first":1,"last":5,"curve":)"
        R"("<animate attribute=\"magnitude\"><key frame=\"1\" value=\"2\"/>)"
        R"(<key frame=\"4\" value=\"3\"/></animate>"}])");
  CHECK(to_json({}).value() == "[]");
  CHECK(parse_operations("[]").value().empty());
}

const edit::SetCurve& curve_in(const std::vector<Operation>& operations) {
  return std::get<edit::SetCurve>(operations.at(0));
}

std::vector<Operation> with_curve(const std::string& text) {
  const nlohmann::json json = {{{"op", "setCurve"}, {"channel", "a.b"}, {"curve", text}}};
  return parse_operations(json.dump()).value();
}

TEST_CASE("a curve is read as a scene has it", "[document][json]") {
  const auto one = with_curve(
      "\n<animate attribute='any' after=\"repeat\">\n <!-- c --><key frame='1' value='2' "
      "interpolation='linear'/>\n<key frame='3' value='4'/></animate> ");
  const auto& numbers = std::get<CurveKeys<1>>(curve_in(one).keys);
  CHECK(numbers.keys.size() == 2);
  CHECK(numbers.keys[0].next.kind == Interpolation::Kind::Linear);
  CHECK(numbers.after.kind == Extrapolation<1>::Kind::Repeat);
  // Vectors, one of which has the same components, and booleans.
  const auto vectors = with_curve(
      "<animate attribute='c'><key frame='1' value='5'/><key frame='2' value='1 2 3'/></animate>");
  CHECK(std::get<CurveKeys<3>>(curve_in(vectors).keys).keys[0].value == Value<3>{5, 5, 5});
  const auto booleans =
      with_curve("<animate attribute='c'><key frame='1' value='true'/></animate>");
  const auto& key = std::get<CurveKeys<1>>(curve_in(booleans).keys).keys[0];
  CHECK(key.value[0] == 1);
  CHECK(key.next.kind == Interpolation::Kind::Step);
}

std::string refusal(const std::string& json) {
  const auto read = parse_operations(json);
  REQUIRE_FALSE(read);
  CHECK(read.error().others.empty());
  CHECK(read.error().message == printable(read.error().message));
  return read.error().message;
}

TEST_CASE("JSON that is no list of operations is refused with the reason", "[document][json]") {
  CHECK(refusal("") == "the file is not a list of operations: it is not valid JSON from here on");
  CHECK(refusal("{}") == "operations must be a list");
  CHECK(refusal("[1]") == "operations[0] is not an object");
  CHECK(refusal("[{}]") == "operations[0].op is missing; it must be the name of an operation");
  CHECK(refusal(R"([{"op":3}])") == "operations[0].op is 3; it must be the name of an operation");
  CHECK_THAT(refusal(R"([{"op":"setkey"}])"),
             contains_text("operations[0].op is \"setkey\"; did you mean \"setKey\"? allowed: "));
  CHECK(refusal(R"([{"op":"reset","path":"a.b"},{"op":"setKey","channel":"a.b"}])") ==
        "operations[1].frame of setKey is missing; it must be a number");
  CHECK(refusal(R"([{"op":"setKey","channel":"a.b","frame":"12"}])") ==
        "operations[0].frame of setKey is \"12\"; it must be a number");
  CHECK(refusal(R"([{"op":"setKey","channel":"a.b","frame":1,"value":8000}])") ==
        "operations[0].value of setKey is 8000; it must be a text");
  CHECK(refusal(R"([{"op":"setKey","channel":"a.b","frame":1,"value":null}])") ==
        "operations[0].value of setKey is null; it must be a text");
  CHECK(refusal(R"([{"op":"set","path":"a.b","value":"1","frame\n":1}])") ==
        "operations[0] has no member \"frame \" of set; allowed: op, path, value");
  CHECK_THAT(refusal(R"([{"op":"set","path":"a.b","valu":"1"}])"),
             contains_text("operations[0].value of set is missing"));
  CHECK(refusal(R"([{"op":"deleteKeys","keys":[{"channel":"a.b","frames":[1,"2"]}]}])") ==
        "operations[0].keys[0].frames of deleteKeys has \"2\"; it must be a list of numbers");
  CHECK(refusal(R"([{"op":"deleteKeys","keys":[{"channel":"a.b","frames":[],"at":1}]}])") ==
        "operations[0].keys[0] has no member \"at\" of deleteKeys; allowed: channel, frames");
  CHECK(refusal(R"([{"op":"deleteKeys","keys":{"a.b":[1]}}])") ==
        "operations[0].keys of deleteKeys is an object; it must be a list of objects");
  CHECK(refusal(R"([{"op":"delete","objects":["a",[]]}])") ==
        "operations[0].objects of delete has a list; it must be a list of texts");
  CHECK(refusal(R"([{"op":"moveKeys","keys":[],"collision":"keep"}])") ==
        "operations[0].collision of moveKeys is \"keep\"; allowed: refuse, replace");
  CHECK(refusal(R"([{"op":"setHandle","channel":"a","frame":1,"side":"both","handle":"1"}])") ==
        "operations[0].side of setHandle is \"both\"; allowed: in, out");
  CHECK(refusal(R"([{"op":"scale","channels":[],"factor":1,"digits":1.5}])") ==
        "operations[0].digits of scale is 1.5; it must be a whole number");
  CHECK(refusal(R"([{"op":"scale","channels":[],"factor":1,"digits":-1}])") ==
        "operations[0].digits of scale is -1; it must be at least 0");
  CHECK(refusal(R"([{"op":"scale","channels":[],"factor":1,"digits":3000000000}])") ==
        "operations[0].digits of scale is 3000000000; it must be a whole number");
  CHECK(refusal(R"([{"op":"bakeKeys","channels":[],"first":1,"last":2,"isLinear":1}])") ==
        "operations[0].isLinear of bakeKeys is 1; it must be true or false");
  CHECK_THAT(refusal(R"([{"op":"set","op":"set"}])"), contains_text("two members of one name"));
  CHECK_THAT(refusal(R"([{"op":"setKey","channel":"a","frame":1e999}])"),
             contains_text("a number that is too large"));
  CHECK_THAT(refusal(std::string(300, '[')), contains_text("nested more than"));
}

TEST_CASE("a curve in JSON is refused with the reason", "[document][json]") {
  const auto refused = [](const std::string& curve) {
    const nlohmann::json json = {{{"op", "setCurve"}, {"channel", "a.b"}, {"curve", curve}}};
    const std::string message = refusal(json.dump());
    const std::string begin = "operations[0].curve of setCurve is refused: ";
    CHECK(message.starts_with(begin));
    return message.substr(std::min(begin.size(), message.size()));
  };
  CHECK(refused("<animate attribute='b'><key frame='1' value='x'/></animate>") ==
        "line 1: <key> value=\"x\": not a number");
  CHECK(refused("<animate attribute='b'>\n<key frame='1' value='$x'/></animate>") ==
        "line 2: <key> value=\"$x\": not a number");
  CHECK_THAT(refused("<animate attribute='b'/>"), contains_text("at least one <key>"));
  CHECK_THAT(refused("<animate><key frame='1' value='1'/></animate>"),
             contains_text("needs the attribute \"attribute\""));
  CHECK_THAT(refused("<falloff><key at='1' value='1'/></falloff>"), contains_text("<falloff>"));
  CHECK_THAT(refused(""), contains_text("must contain one"));
  CHECK_THAT(refused("<animate attribute='b'><key frame='2' value='1'/><key frame='1' "
                     "value='1'/></animate>"),
             contains_text("increasing order"));
  CHECK_THAT(refused("<animate attribute='b'><key frame='1' value='1'/><key frame='2' "
                     "value='1'/><loop from='1' to='3' after='1000000'/></animate>"),
             contains_text("copied keys"));
  CHECK(refusal(R"([{"op":"splice","channel":"a.b","first":1,"last":2,"curve":{}}])") ==
        "operations[0].curve of splice is an object; it must be the text of an <animate>");
  // The copies of all loops together.
  const nlohmann::json one = {
      {"op", "setCurve"},
      {"channel", "a.b"},
      {"curve",
       "<animate attribute='b'><key frame='1' value='1'/><loop from='1' to='2' "
       "after='600000'/></animate>"}};
  CHECK(parse_operations(nlohmann::json::array({one}).dump()));
  CHECK_THAT(refusal(nlohmann::json({one, one}).dump()),
             contains_text("operations[1].curve of setCurve is refused: line 1: <loop> makes"));
}

TEST_CASE("what JSON cannot say is not written", "[document][json]") {
  const auto refused = [](const Operation& operation) {
    const auto json = to_json({edit::Reset{"a"}, operation});
    REQUIRE_FALSE(json);
    return json.error().message;
  };
  CHECK(refused(edit::SetKey{"a.b", std::numeric_limits<double>::infinity()}) ==
        "operations[1]: frame of setKey is inf; it must be finite");
  CHECK(refused(edit::DeleteKeys{{{"a.b", {std::nan("")}}}}) ==
        "operations[1]: frames of deleteKeys is nan; it must be finite");
  CHECK(refused(edit::Rename{"a", "\xFF"}) ==
        "operations[1]: name of rename has bytes that are not UTF-8");
  CHECK(refused(edit::SetHandle{"a.b", 1, edit::Side::Both, "1"}) ==
        "operations[1]: side of setHandle is no word: in, out");
  CHECK_THAT(refused(edit::SetCurve{"a.b", CurveKeys<1>{}}),
             contains_text("operations[1]: curve of setCurve cannot be written: "));
}

TEST_CASE("the reading of operations can be stopped", "[document][json]") {
  std::string many = "[";
  for (int k = 0; k < 20000; ++k) many += R"({"op":"reset","path":"a.b"},)";
  many.back() = ']';
  int asked = 0;
  const auto read = parse_operations(many, [&] { return ++asked > 3; });
  REQUIRE_FALSE(read);
  CHECK(read.error().code == ErrorCode::Interrupted);
}

TEST_CASE("the list of operations says all that another language needs", "[document][json]") {
  const std::vector<OperationFormat>& formats = operation_formats();
  REQUIRE(formats.size() == std::variant_size_v<Operation>);
  const auto find = [&](std::string_view operation, std::string_view member) {
    const auto found = std::ranges::find(formats, operation, &OperationFormat::name);
    REQUIRE(found != formats.end());
    const auto of = std::ranges::find(found->members, member, &MemberFormat::name);
    REQUIRE(of != found->members.end());
    return *of;
  };
  CHECK(find("setKey", "value").standard == "(that of the curve)");
  CHECK(find("setKey", "value").type == "text");
  CHECK(find("moveKeys", "collision").standard == "\"refuse\"");
  CHECK(find("moveKeys", "collision").words.size() == 2);
  CHECK(find("moveKeys", "rise").type == "numbers");
  CHECK(find("scaleKeys", "timeFactor").range == "> 0");
  CHECK(find("scaleKeys", "timeFactor").standard == "1");
  CHECK(find("scaleKeys", "valueFactor").standard == "(1)");
  CHECK(find("bakeKeys", "step").standard == "1");
  CHECK(find("bakeKeys", "step").unit == "frame");
  for (const char* const name : {"scale", "moveKeys", "scaleKeys"})
    CHECK(find(name, "digits").range == "≥ 0");
  CHECK(find("splice", "curve").type == "curve");
  CHECK(find("deleteKeys", "keys").members.size() == 2);
  CHECK(find("add", "attributes").members[0].name == "attribute");
  const std::set<std::string_view> types = {"text",  "number",  "integer", "boolean", "word",
                                            "texts", "numbers", "curve",   "objects"};
  for (const OperationFormat& operation : formats) {
    CHECK(operation.meaning.ends_with('.'));
    for (const MemberFormat& member : operation.members) {
      CAPTURE(operation.name, member.name);
      CHECK(types.contains(member.type));
      CHECK_FALSE(member.meaning.empty());
      CHECK(member.is_required == member.standard.empty());
      CHECK((member.type == "word") == !member.words.empty());
      CHECK((member.type == "objects") == !member.members.empty());
    }
    // What is optional is optional, what is required is not.
    nlohmann::json needed = {{"op", operation.name}};
    const auto read = [&] { return parse_operations(nlohmann::json::array({needed}).dump()); };
    for (const MemberFormat& member : operation.members) {
      if (!member.is_required) continue;
      CHECK_FALSE(read());
      const std::string curve = "<animate attribute='b'><key frame='1' value='1'/></animate>";
      needed[std::string(member.name)] = member.type == "curve"    ? nlohmann::json(curve)
                                         : member.type == "text"   ? nlohmann::json("a")
                                         : member.type == "number" ? nlohmann::json(1)
                                                                   : nlohmann::json::array();
    }
    REQUIRE(read());
    // Defaults may be given, and change nothing.
    const std::string before = to_json(read().value()).value();
    for (const MemberFormat& member : operation.members)
      if (!member.is_required && !member.standard.starts_with('('))
        needed[std::string(member.name)] = nlohmann::json::parse(member.standard);
    CHECK(to_json(read().value()).value() == before);
  }
}

}  // namespace
}  // namespace pliant::testing
