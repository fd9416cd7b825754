#include "pliant/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "pliant/files/read_file.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/replay/expect_replay.hpp"
#include "pliant/replay/log_file.hpp"
#include "pliant/scene/read.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using Catch::Matchers::StartsWith;

namespace {

// Two surfaces under a force that moves and rests; the second one has a start frame of its own.
constexpr std::string_view scene_xml = R"(<scene version="1" start="1" end="10">
  <surface name="sheet"><grid columns="13" rows="11" width="12" depth="10"/></surface>
  <surface name="other">
    <grid columns="9" rows="10" width="8" depth="9"/>
    <solver startFrame="4" release="recover"/>
  </surface>
  <point name="poke" deformationRadius="4.5" forceRadius="2.5" magnitude="3000">
    <animate attribute="center">
      <key frame="1" value="-2 0 0"/>
      <key frame="10" value="2 0 1"/>
    </animate>
  </point>
</scene>
)";

// A sheet as an OBJ file, one of whose vertices may be moved.
std::string sheet_obj(double moved_by = 0) {
  const Mesh mesh = make_mesh({.columns = 11, .rows = 11, .width = 10, .depth = 10});
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k) {
    text << "v " << mesh.positions(k, 0) << ' ' << mesh.positions(k, 1) + (k == 50 ? moved_by : 0)
         << ' ' << mesh.positions(k, 2) << '\n';
  }
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 11; ++i) text << "vt " << i << ' ' << j << '\n';
  }
  for (int j = 0; j < 10; ++j) {
    for (int i = 0; i < 10; ++i) {
      const int first = 11 * j + i + 1;
      text << 'f';
      for (const int corner : {first, first + 1, first + 12, first + 11}) {
        text << ' ' << corner << '/' << corner;
      }
      text << '\n';
    }
  }
  return text.str();
}

constexpr std::string_view mesh_scene_text = R"(<scene version="1" start="1" end="6">
  <surface name="sheet"><mesh file="sheet.obj"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4.5" forceRadius="2.5" magnitude="3000"/>
</scene>
)";

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string changed(text);
  const std::size_t place = changed.find(from);
  REQUIRE(place != std::string::npos);
  return changed.replace(place, from.size(), to);
}

std::string record(const std::filesystem::path& scene, const std::filesystem::path& log,
                   const ReplayOptions& options = {}) {
  const auto recorded = record_replay(scene, log, options);
  if (!recorded) FAIL(to_lines(recorded.error()).front());
  return read_file(log).value();
}

// The lines of a comparison or of its error.
std::vector<std::string> said(const Result<ReplayVerdict>& verdict) {
  return verdict ? verdict->lines() : to_lines(verdict.error());
}

// Reads a log, changes it and writes it again, as if another machine had recorded it.
template <class Change>
void rewrite(const std::filesystem::path& from, const std::filesystem::path& to,
             const Change& change) {
  auto log = ReplayLogReader::open(from).value();
  ReplayHeader header = log.header();
  std::vector<ReplayFrame> frames;
  for (auto frame = log.next().value(); frame; frame = log.next().value()) {
    frames.push_back(*std::move(frame));
  }
  change(header, frames);
  auto written = ReplayLogWriter::create(to, header).value();
  for (const ReplayFrame& frame : frames) REQUIRE(written.write(frame));
  REQUIRE(written.finish());
}

// 1.234.567,5
struct GroupedNumbers : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\1"; }
};

class GlobalLocale {
 public:
  explicit GlobalLocale(const std::locale& locale) : before_(std::locale::global(locale)) {}
  GlobalLocale(const GlobalLocale&) = delete;
  GlobalLocale& operator=(const GlobalLocale&) = delete;
  ~GlobalLocale() { std::locale::global(before_); }

 private:
  std::locale before_;
};

}  // namespace

TEST_CASE("what was recorded is verified, with states and without", "[replay]") {
  const ScratchFolder folder;
  const auto scene = folder.write("scene.xml", scene_xml);
  const auto log = folder.file("run.replay");
  const int states_every = GENERATE(0, 1, 4);
  record(scene, log, {.states_every = states_every});
  long done = 0;
  const auto verdict = verify_replay(log, {}, {.frame_done = [&](long) { ++done; }});
  REQUIRE(verdict);
  CHECK(said(verdict).empty());
  CHECK(verdict->holds());
  CHECK(verdict->frame_count == 10);
  CHECK(done == 10);
  CHECK(compare_replays(log, log)->holds());
  CHECK(expect_replay(scene, log) == "");
}

TEST_CASE("a log has the states it was asked for", "[replay]") {
  const ScratchFolder folder;
  const auto scene = folder.write("scene.xml", scene_xml);
  record(scene, folder.file("run.replay"), {.states_every = 4});
  auto log = ReplayLogReader::open(folder.file("run.replay")).value();
  auto simulation = Simulation::make(load_scene(scene).value()).value();
  std::vector<int> frames_with_states;
  for (auto frame = log.next().value(); frame; frame = log.next().value()) {
    if (frame->states.empty()) continue;
    frames_with_states.push_back(frame->number);
    REQUIRE(simulation.report(frame->number));
    for (std::size_t k = 0; k < 2; ++k) {
      CHECK((frame->states[k].positions == simulation.state(k).positions));
      CHECK((frame->states[k].velocities == simulation.state(k).velocities));
      CHECK((frame->surfaces[k].positions == hash_of(frame->states[k].positions)));
      CHECK((frame->surfaces[k].velocities == hash_of(frame->states[k].velocities)));
    }
  }
  CHECK(frames_with_states == std::vector<int>{1, 5, 9});
}

TEST_CASE("a log has the same bytes whatever runs it", "[replay][threads]") {
  const ScratchFolder folder;
  const auto scene = folder.write("scene.xml", scene_xml);
  const std::string expected = record(scene, folder.file("run.replay"), {.states_every = 3});
  SECTION("threads") {
    for (const int threads : {2, 3, 8}) {
      const ReplayOptions options{.simulation = {.threads = threads}, .states_every = 3};
      CHECK((record(scene, folder.file("again.replay"), options) == expected));
      CHECK(said(verify_replay(folder.file("run.replay"), {}, options)).empty());
    }
  }
  SECTION("width of vectors") {
    for (const int lanes : {2, 4, 8}) {
      const ReplayOptions options{.simulation = {.most_lanes = lanes}, .states_every = 3};
      CHECK((record(scene, folder.file("again.replay"), options) == expected));
    }
  }
  SECTION("locale") {
    const GlobalLocale locale(std::locale(std::locale::classic(), new GroupedNumbers));
    CHECK((record(scene, folder.file("again.replay"), {.states_every = 3}) == expected));
    CHECK(said(verify_replay(folder.file("run.replay"))).empty());
  }
  SECTION("folder") {
    const ScratchFolder other;
    const auto moved = other.write("scene.xml", scene_xml);
    CHECK((record(moved, other.file("run.replay"), {.states_every = 3}) == expected));
  }
}

TEST_CASE("a log goes no further than it is asked to", "[replay]") {
  const ScratchFolder folder;
  const auto scene = folder.write("scene.xml", scene_xml);
  const auto log = folder.file("run.replay");
  record(scene, log, {.last_frame = 4});
  CHECK(verify_replay(log)->frame_count == 4);
  CHECK(verify_replay(log)->holds());
  for (const int outside : {0, 11}) {
    const auto refused = record_replay(scene, log, {.last_frame = outside});
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().message, Contains("frames 1 to 10"));
  }
}

TEST_CASE("the first difference is named to the node and its size", "[replay]") {
  const ScratchFolder folder;
  const auto scene = folder.write("scene.xml", scene_xml);
  const auto log = folder.file("run.replay");
  const auto faulty = folder.file("faulty.replay");
  record(scene, log, {.states_every = 1});

  struct Fault {
    int frame;
    std::size_t surface;
    int node;
    bool is_velocity;
    std::string expected;
  };
  const Fault fault =
      GENERATE(Fault{3, 0, 0, false,
                     "frame 3: surface \"sheet\": positions differ, most at node (0,0), by "},
               Fault{7, 0, 13 * 4 + 5, true,
                     "frame 7: surface \"sheet\": velocities differ, most at node (5,4), by "},
               Fault{10, 1, 9 * 9 + 8, false,
                     "frame 10: surface \"other\": positions differ, most at node (8,9), by "});
  double size = 0;
  rewrite(log, faulty, [&](const ReplayHeader&, std::vector<ReplayFrame>& frames) {
    ReplayFrame& frame = frames[static_cast<std::size_t>(fault.frame - 1)];
    BodyState& state = frame.states[fault.surface];
    Field& field = fault.is_velocity ? state.velocities : state.positions;
    double& number = field(fault.node, 1);
    const double before = number;
    number = std::nextafter(number, 1e300);
    size = number - before;
    SurfaceDigest& digest = frame.surfaces[fault.surface];
    (fault.is_velocity ? digest.velocities : digest.positions) = hash_of(field);
  });
  for (const auto& verdict : {verify_replay(faulty), compare_replays(log, faulty)}) {
    REQUIRE(verdict);
    CHECK_FALSE(verdict->holds());
    REQUIRE(said(verdict).size() == 1);
    CHECK_THAT(said(verdict).front(), StartsWith(fault.expected));
    CHECK(verdict->differences.front().size == size);
    CHECK(verdict->frame_count == fault.frame);
  }
  const auto all = verify_replay(faulty, {}, {.keeps_going = true});
  REQUIRE(all);
  CHECK(all->differences.size() == 1);
  CHECK(all->frame_count == 10);
}

TEST_CASE("the sign of a zero is a difference", "[replay]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  record(folder.write("scene.xml", scene_xml), log, {.states_every = 1});
  rewrite(log, folder.file("faulty.replay"),
          [](const ReplayHeader&, std::vector<ReplayFrame>& frames) {
            double& number = frames[1].states[0].velocities(3, 2);
            REQUIRE(number == 0);
            number = std::signbit(number) ? 0.0 : -0.0;
            frames[1].surfaces[0].velocities = hash_of(frames[1].states[0].velocities);
          });
  CHECK_THAT(said(verify_replay(folder.file("faulty.replay"))).front(),
             Equals("frame 2: surface \"sheet\": velocities differ, most at node (3,0), by 0"));
}

TEST_CASE("keeping going names every difference in order, by any number of threads",
          "[replay][threads]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  const auto scene = folder.write("scene.xml", scene_xml);
  record(scene, log, {.states_every = 2});
  folder.write("scene.xml", replaced(scene_xml, "magnitude=\"3000\"", "magnitude=\"3001\""));
  const auto alone = verify_replay(log, {}, {.keeps_going = true});
  REQUIRE(alone);
  CHECK_THAT(said(alone).front(),
             Equals("the scene scene.xml was edited; the first change is in line 7"));
  CHECK_THAT(
      said(alone)[1],
      StartsWith("frame 2: surface \"sheet\": positions differ; their peak displacement of"));
  CHECK_THAT(said(alone)[3], StartsWith("frame 3: surface \"sheet\": positions differ, most at"));
  CHECK(alone->differences.size() > 20);
  CHECK(alone->frame_count == 10);
  for (const int threads : {2, 3, 8}) {
    const ReplayOptions options{.simulation = {.threads = threads}, .keeps_going = true};
    CHECK((said(verify_replay(log, {}, options)) == said(alone)));
  }
  record(scene, folder.file("other.replay"), {.states_every = 2});
  CHECK((said(compare_replays(log, folder.file("other.replay"), {.keeps_going = true})) ==
         said(alone)));
}

TEST_CASE("a scene that was edited is told apart, whether it matters or not", "[replay]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  record(folder.write("scene.xml", scene_xml), log);
  const auto edited = [&](std::string_view from, std::string_view to) {
    folder.write("scene.xml", replaced(scene_xml, from, to));
    return verify_replay(log);
  };
  const auto same = edited("</scene>", "<!-- done -->\n</scene>");
  REQUIRE(same);
  CHECK(same->holds());
  CHECK(said(same) ==
        std::vector<std::string>{"the scene scene.xml was edited; the first change is in line 13"});

  const auto frames = edited("end=\"10\"", "end=\"8\"");
  REQUIRE(frames);
  CHECK_FALSE(frames->holds());
  CHECK_THAT(said(frames)[1], Equals("the frames differ: 1 to 10, and 1 to 8"));

  const auto surfaces = edited("columns=\"9\"", "columns=\"8\"");
  REQUIRE(surfaces);
  CHECK_FALSE(surfaces->holds());
  CHECK(surfaces->frame_count == 0);
  CHECK_THAT(said(surfaces)[1], Contains("\"other\" (9 x 10), and") && Contains("(8 x 10)"));

  CHECK(edited("end=\"10\"", "end=\"20\"")->holds());

  const auto broken = edited("columns=\"9\"", "columns=\"nine\"");
  REQUIRE_FALSE(broken);
  CHECK(broken.error().line == 4);
}

TEST_CASE("without its scene a log is verified by the text in it", "[replay]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  const auto scene = folder.write("scene.xml", scene_xml);
  record(scene, log);
  std::filesystem::remove(scene);
  const auto verdict = verify_replay(log);
  REQUIRE(verdict);
  CHECK(verdict->holds());
  CHECK(verdict->frame_count == 10);
  CHECK_THAT(said(verdict).front(), Contains("scene.xml does not exist"));
  const auto missing = verify_replay(log, scene);
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ErrorCode::Unreadable);
}

TEST_CASE("a mesh that was changed is told apart", "[replay]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  folder.write("sheet.obj", sheet_obj());
  record(folder.write("scene.xml", mesh_scene_text), log, {.states_every = 1});
  CHECK(said(verify_replay(log)).empty());

  folder.write("sheet.obj", sheet_obj() + "# a remark\n");
  CHECK(verify_replay(log)->holds());
  CHECK(said(verify_replay(log)) == std::vector<std::string>{"the file sheet.obj was changed"});

  folder.write("sheet.obj", sheet_obj(0.25));
  CHECK(said(verify_replay(log)) ==
        std::vector<std::string>{
            "the file sheet.obj was changed",
            "frame 1: surface \"sheet\": positions differ, most at node (6,4), by 0.25"});

  folder.write("sheet.obj", "v 0 0\n");
  const auto broken = verify_replay(log);
  REQUIRE_FALSE(broken);
  CHECK_THAT(to_lines(broken.error()).back(), Contains("sheet.obj was changed"));
  std::filesystem::remove(folder.file("sheet.obj"));
  const auto missing = verify_replay(log);
  REQUIRE_FALSE(missing);
  CHECK_THAT(to_lines(missing.error()).front(), Contains("sheet.obj"));
}

TEST_CASE("another version and another solver are told apart", "[replay]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  const auto other = folder.file("other.replay");
  record(folder.write("scene.xml", scene_xml), log);
  rewrite(log, other, [](ReplayHeader& header, const auto&) { header.version = "0.0.7"; });
  CHECK_THAT(said(verify_replay(other)).front(),
             StartsWith("the versions of pliant differ: 0.0.7 and "));
  CHECK(verify_replay(other)->holds());
  rewrite(log, other, [](ReplayHeader& header, const auto&) { header.factors = "abacus"; });
  CHECK_THAT(said(verify_replay(other)).front(),
             StartsWith("the solvers differ: auto (abacus) and "));
  rewrite(log, other, [](ReplayHeader& header, const auto&) { header.solver = "abacus"; });
  CHECK_FALSE(verify_replay(other));
}

TEST_CASE("a log is verified by the solver that recorded it", "[replay]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  record(folder.write("scene.xml", scene_xml), log,
         {.simulation = {.solver = SolverChoice::Eigen}});
  CHECK(verify_replay(log)->holds());
  CHECK(ReplayLogReader::open(log)->header().solver == "eigen");
}

TEST_CASE("comparing logs finds where either was damaged", "[replay]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  const std::string sound = record(folder.write("scene.xml", scene_xml), log);
  const auto cut = folder.write("cut.replay", sound.substr(0, sound.rfind("{\"frames\"")));
  for (const auto& verdict :
       {compare_replays(log, cut), compare_replays(cut, log), verify_replay(cut)}) {
    REQUIRE_FALSE(verdict);
    CHECK(verdict.error().line == 12);
    CHECK_THAT(verdict.error().message, Contains("is truncated") && Contains("10 of 10 frames"));
  }
}

TEST_CASE("a log takes the place of no file that it is made from", "[replay]") {
  const ScratchFolder folder;
  const auto scene = folder.write("scene.xml", mesh_scene_text);
  const auto mesh = folder.write("sheet.obj", sheet_obj());
  std::filesystem::create_symlink("sheet.obj", folder.file("link.replay"));
  for (const auto& place : {scene, mesh, folder.file("link.replay"), folder.path()}) {
    const auto refused = record_replay(scene, place);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::InvalidInput);
  }
  CHECK(read_file(scene).value() == mesh_scene_text);
  CHECK(read_file(mesh).value() == sheet_obj());
  CHECK(folder.entry_count() == 3);
}

TEST_CASE("a recording that is stopped leaves nothing", "[replay]") {
  const ScratchFolder folder;
  const auto scene = folder.write("scene.xml", scene_xml);
  int steps_left = 100;
  const auto stopped =
      record_replay(scene, folder.file("run.replay"),
                    {.simulation = {.should_stop = [&] { return --steps_left < 0; }}});
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
  CHECK(folder.entry_count() == 1);
}

TEST_CASE("what a program's tests are told is all that is wrong", "[replay]") {
  const ScratchFolder folder;
  const auto log = folder.file("run.replay");
  const auto scene = folder.write("scene.xml", scene_xml);
  record(scene, log);
  folder.write("scene.xml", replaced(scene_xml, "magnitude=\"3000\"", "magnitude=\"3001\""));
  const std::string told = expect_replay(scene, log);
  CHECK_THAT(told, StartsWith("the scene scene.xml was edited; the first change is in line "
                              "7\nframe 2: surface \"sheet\": positions differ; their peak"));
  CHECK(std::count(told.begin(), told.end(), '\n') == 2);
  CHECK_THAT(expect_replay(scene, folder.file("none")), Contains("none"));
}

TEST_CASE("a program records a scene that no file can contain, and verifies it", "[replay]") {
  const ScratchFolder scratch;
  const std::string log = scratch.file("own.replay");
  const auto simulation_with = [](double strength) {
    Scene scene;
    scene.end = 8;
    scene.surfaces.push_back(
        {.name = "sheet",
         .shape = make_mesh({.columns = 11, .rows = 11, .width = 10, .depth = 10})});
    Force own{.name = "own", .targets = {}, .magnitude = 900, .deformation_radius = 4};
    own.kind = CustomForce{.unit_force = [strength](const Vector3d& p, const ForceTime& time) {
      return Vector3d(0, strength + p.x() * 0.1 + time.frame, 0);
    }};
    scene.forces.push_back(own);
    return Simulation::make(std::move(scene)).value();
  };
  auto recorded = simulation_with(1);
  REQUIRE(recorded.at(5));  // any frame before
  const auto header = record_replay(recorded, log, {.states_every = 3});
  REQUIRE(header);
  CHECK(header->scene_file.empty());
  CHECK(header->scene_text.empty());

  auto same = simulation_with(1);
  const auto verdict = verify_replay(log, same);
  REQUIRE(verdict);
  CHECK(verdict->holds());
  CHECK(verdict->frame_count == 8);
  auto other = simulation_with(1 + 1e-12);
  const auto differs = verify_replay(log, other);
  REQUIRE(differs);
  REQUIRE_FALSE(differs->holds());
  CHECK_THAT(differs->lines().front(), StartsWith("frame 2: surface \"sheet\": positions differ"));

  const auto by_command = verify_replay(log);
  REQUIRE_FALSE(by_command);
  CHECK(by_command.error().code == ErrorCode::InvalidInput);
  CHECK_THAT(by_command.error().message, Contains("only the program can verify it"));
}

TEST_CASE("a program's log is verified without the program if it has the scene", "[replay]") {
  const ScratchFolder scratch;
  const std::string log = scratch.file("code.replay");
  Scene scene = parse_scene(scene_xml, "", "").value();
  scene.origin = {};
  auto simulation = Simulation::make(scene).value();
  const auto header = record_replay(simulation, log);
  REQUIRE(header);
  CHECK(header->scene_file.empty());
  const auto verdict = verify_replay(log);
  REQUIRE(verdict);
  CHECK(verdict->holds());
  CHECK(verdict->lines().empty());

  // The log of a file, by the program that read it; and another solver.
  const std::string file = scratch.write("scene.xml", scene_xml);
  REQUIRE(record_replay(file, log));
  auto loaded = Simulation::make(load_scene(file).value()).value();
  CHECK(verify_replay(log, loaded).value().holds());
  auto by_eigen = Simulation::make(scene, {.solver = SolverChoice::Eigen}).value();
  const auto refused = verify_replay(log, by_eigen);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("solver auto, but the simulation uses eigen"));
  scene.forces.front().magnitude = 1;
  auto edited = Simulation::make(scene).value();
  REQUIRE(record_replay(simulation, log));
  const auto told = verify_replay(log, edited).value();
  CHECK_FALSE(told.holds());
  CHECK_THAT(told.lines().front(), StartsWith("the scene of the program was edited"));
}
