#include "editor/edit_session.hpp"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "editor/motion.hpp"
#include "editor/new_object.hpp"
#include "pliant/core/text.hpp"
#include "pliant/document/operation_json.hpp"
#include "pliant/document/properties.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/inputs.hpp"
#include "pliant/scene/read.hpp"

namespace pliant::editor {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto between_looks = 250ms;     // at the disk
constexpr auto between_journals = 500ms;  // written
constexpr std::size_t most_take_bytes = 64'000'000;
constexpr const char* no_scene = "there is no scene yet";

// As it is named if the current folder is gone.
fs::path absolute(const std::string& file) {
  std::error_code unknown;
  fs::path place = fs::absolute(file, unknown);
  return unknown ? fs::path(file) : place;
}

Json to_json(const TextEdit& edit) {
  return {{"at", edit.at}, {"removed", edit.removed}, {"inserted", edit.inserted}};
}

// How work ends: with a refusal, or with what is to be done with its result.
template <class Value, class Act>
std::function<HttpAnswer()> finish(const Result<Value>& result, Act act) {
  if (!result) return [answer = refusal(result.error())] { return answer; };
  return [value = *result, act] { return act(value); };
}

std::string is_there(const std::string& file) {
  return fmt::format("{} is there already", printable(file));
}

Result<void> would_overwrite(const fs::path& file, const fs::path& input) {
  return fail(ErrorCode::InvalidInput,
              fmt::format("{}: would overwrite {}, an input of the scene; choose another name",
                          printable(file.string()), printable(input.string())));
}

std::string no_take(std::int64_t id) { return fmt::format("there is no take {}", id); }

Json reached_by(const Suggestion& suggestion) {
  Json reached = Json::object();
  const auto add = [&](const char* name, const std::optional<GoalResult>& goal) {
    if (!goal) return;
    const bool is_known = goal->is_known && std::isfinite(goal->found);
    reached[name] = {{"value", is_known ? Json(goal->found) : Json()}, {"reason", goal->reason}};
  };
  add("peak", suggestion.peak);
  add("settling", suggestion.settling);
  add("frequency", suggestion.frequency);
  return reached;
}

}  // namespace

Json to_json(const Error& error) {
  Json errors = Json::array();
  const auto add = [&](const Error& one) {
    errors.push_back({{"message", one.message}, {"file", one.file}, {"line", one.line}});
  };
  add(error);
  for (const Error& other : error.others) add(other);
  return errors;
}

EditSession::EditSession(SessionOptions options, std::function<void()> notify)
    : options_(std::move(options)),
      notify_(std::move(notify)),
      solver_({.simulation = options_.simulation, .notify = notify_}),
      takes_(std::min(options_.simulation.max_memory / 32, most_take_bytes)),
      ghosts_(solver_, options_.simulation) {}

Result<std::unique_ptr<EditSession>> EditSession::open(SessionOptions options,
                                                       std::function<void()> notify) {
  std::unique_ptr<EditSession> session(new EditSession(std::move(options), std::move(notify)));
  const std::string& file = session->options_.file;
  session->open_journal();
  std::error_code unknown;
  if (file.empty() || !fs::exists(file, unknown)) return session;
  auto document = SceneDocument::open(file, session->document_options());
  if (!document) return fail(document.error());
  session->start(*std::move(document), true);
  return session;
}

DocumentOptions EditSession::document_options() {
  SimulationOptions check = options_.simulation;
  check.shelf = &solver_.shelf();
  return {.root = options_.root,
          .check = [check](const Scene& scene) -> Result<void> {
            if (const auto notes = Simulation::check(scene, check); !notes)
              return fail(notes.error());
            return {};
          },
          .follows_links = true,
          .should_stop = options_.simulation.should_stop};
}

void EditSession::open_journal() {
  if (options_.journals.empty()) {
    journal_fault_ = "neither XDG_STATE_HOME nor HOME is known";
    return;
  }
  std::error_code unknown;
  const fs::path file =
      options_.file.empty() ? fs::path(options_.root) / "" : absolute(options_.file);
  auto journal = Journal::open(options_.journals, fs::weakly_canonical(file, unknown).string());
  journal_fault_ = journal ? "" : journal.error().message;
  journal_ = journal ? std::optional(*std::move(journal)) : std::nullopt;
}

void EditSession::start(SceneDocument document, bool is_on_disk) {
  document_ = std::move(document);
  is_on_disk_ = is_on_disk;
  is_gone_ = is_changed_on_disk_ = false;
  stamp_ = own_stamp();
  // What is left is no news if the file has it.
  if (journal_ && is_on_disk) journal_->take_left(document_->text());
  ++revision_;
  play();
}

void EditSession::play() {
  watch();
  solver_.take(revision_, document_->scene());
  notify_();
}

void EditSession::watch() {
  std::map<fs::path, FileStamp> others;
  for (const SceneInput& input : inputs_of(document_->scene(), options_.simulation.should_stop)) {
    std::error_code unknown;
    if (is_on_disk_ && fs::equivalent(input.file, document_->file(), unknown)) continue;
    const auto known = others_.find(input.file);
    others.emplace(input.file, known != others_.end() ? known->second : stamp_of(input.file));
  }
  others_ = std::move(others);
}

bool EditSession::is_saved() const {
  return !document_ || (is_on_disk_ && !is_gone_ && document_->is_saved());
}

std::string EditSession::told_name() const {
  return options_.file.empty() ? "the new scene" : options_.file;
}

std::string EditSession::folder_of_file() const {
  if (options_.file.empty()) return options_.root;
  std::error_code unknown;
  return fs::weakly_canonical(absolute(options_.file).parent_path(), unknown).string();
}

// As pages see it.
std::string EditSession::file_in_root() const {
  if (options_.file.empty()) return "";
  std::error_code unknown;
  return fs::weakly_canonical(absolute(options_.file), unknown)
      .lexically_relative(options_.root)
      .string();
}

Json EditSession::document_json() const {
  const Scene* const scene = document_ ? &document_->scene() : nullptr;
  Json json = {{"revision", revision_},
               {"file", file_in_root()},
               {"text", document_ ? Json(document_->text()) : Json()},
               {"saved", is_saved()},
               {"changedOnDisk", is_changed_on_disk_},
               {"undo", document_ ? document_->undo_name() : ""},
               {"redo", document_ ? document_->redo_name() : ""},
               {"start", scene ? scene->start : 0},
               {"end", scene ? scene->end : 0},
               {"fps", scene ? scene->fps : 0},
               {"journal", nullptr},
               {"journalFault", journal_fault_}};
  if (journal_ && journal_->left()) json["journal"] = {{"time", journal_->left()->time}};
  return json;
}

HttpAnswer EditSession::document() const { return json_answer(document_json()); }

HttpAnswer EditSession::objects(std::optional<Revision> revision) const {
  if (revision && *revision != revision_) return refusal(409, "there is another revision by now");
  auto objects = document_ ? properties_json(*document_) : Result<std::string>("[]");
  if (!objects) return refusal(objects.error());
  return text_answer(fmt::format(R"({{"revision":{},"document":{},"objects":{}}})", revision_,
                                 text_of(document_json()), *objects));
}

HttpAnswer EditSession::starters() const {
  Json json = options_.tools.starters ? options_.tools.starters() : Json::object();
  json["scenes"] = scenes_below(options_.root);
  json["meshes"] = meshes_below(options_.root);
  return json_answer(json);
}

HttpAnswer EditSession::picture(const std::string& starter) const {
  auto picture = options_.tools.picture ? options_.tools.picture(starter) : std::nullopt;
  if (!picture) return {.status = 404};
  return text_answer(*std::move(picture), 200, "image/png");
}

HttpAnswer EditSession::picture_of_take(std::int64_t id) const {
  const Take* const take = takes_.find(id);
  if (!take || !take->picture) return {.status = 404};
  return {.type = "image/png", .body = take->picture};
}

// The answer to what changed the text.
HttpAnswer EditSession::changed(const Change& change, const Json& more) {
  if (!change.edits.empty()) {
    gesture_.clear();  // this is the last step
    ++revision_;
    play();
  } else {
    notify_();
  }
  Json edits = Json::array();
  for (const TextEdit& edit : change.edits) edits.push_back(to_json(edit));
  Json json = {{"revision", revision_},
               {"name", change.name},
               {"edits", std::move(edits)},
               {"parts", change.parts}};
  json.update(more);
  return json_answer(json);
}

bool EditSession::is_gesture(const std::string& gesture) const {
  return !gesture.empty() && gesture == gesture_ && document_->can_undo();
}

HttpAnswer EditSession::step(const std::vector<Operation>& operations, const std::string& name,
                             const std::string& gesture, const Json& more) {
  const bool amends = is_gesture(gesture);
  std::string before = amends ? before_gesture_ : document_->text();
  const auto change =
      amends ? document_->amend(operations, name) : document_->apply(operations, name);
  if (!change) return refusal(change.error());
  HttpAnswer answer = changed(*change, more);
  if (amends || !change->edits.empty()) {
    gesture_ = document_->text() != before ? gesture : "";
    before_gesture_ = std::move(before);
  }
  return answer;
}

HttpAnswer EditSession::operations(const Body& body) {
  Members members(body);
  const Body* const list = members.find("operations");
  const std::string name = members.text("name"), gesture = members.text("gesture");
  const std::optional<Revision> revision = members.whole("revision");
  const bool is_cancelled = members.flag("cancel");
  if (auto fault = members.fault()) return *std::move(fault);
  if (list == nullptr && !is_cancelled) return refusal(400, "operations is missing");
  if (is_cancelled && gesture.empty()) return refusal(400, "cancel needs a gesture");
  if (!document_) return refusal(409, no_scene);
  if (revision && *revision != revision_)
    return refusal(409,
                   fmt::format("the document is at revision {}, not {}", revision_, *revision));
  if (is_cancelled) {
    if (!is_gesture(gesture)) return changed({.name = "cancel"});
    const auto change = document_->drop();
    return change ? changed(*change) : refusal(change.error());
  }
  const auto operations = parse_operations(
      list->dump(-1, ' ', false, Body::error_handler_t::replace), options_.simulation.should_stop);
  if (!operations) return refusal(400, operations.error());
  return step(*operations, name, gesture);
}

HttpAnswer EditSession::undo(const Body& body) {
  if (auto fault = Members(body).fault()) return *std::move(fault);
  if (!document_ || !document_->can_undo()) return refusal(409, "there is nothing to undo");
  const auto change = document_->undo();
  return change ? changed(*change) : refusal(change.error());
}

HttpAnswer EditSession::redo(const Body& body) {
  if (auto fault = Members(body).fault()) return *std::move(fault);
  if (!document_ || !document_->can_redo()) return refusal(409, "there is nothing to redo");
  const auto change = document_->redo();
  return change ? changed(*change) : refusal(change.error());
}

Result<fs::path> EditSession::place_of(const std::string& file) const {
  return place_in(options_.root, file);
}

// Of the document's file, which may be a link. Errors: it leads out of the root, or to no file.
Result<fs::path> EditSession::own_place() const {
  return place_of(options_.file.empty() ? "" : absolute(options_.file).string());
}

FileStamp EditSession::own_stamp() const {
  const auto place = own_place();
  return place ? stamp_of(*place) : FileStamp();
}

// Of a scene that is to be written.
Result<fs::path> EditSession::place_of_scene(const std::string& file) const {
  auto place = place_of(file);
  if (place && ending_of(*place) != ".xml")
    return fail(ErrorCode::InvalidInput,
                fmt::format("{}: the name of a scene must end in .xml", printable(file)));
  return place;
}

Result<void> EditSession::check_export(const fs::path& place) const {
  const InputFinder inputs(document_->scene(), options_.simulation.should_stop);
  const auto input = inputs.find(place);
  return input ? would_overwrite(place, *input) : Result<void>();
}

// A scene gets a file of its own: other names of an input stay what they are.
Result<void> EditSession::check_save(const fs::path& place) const {
  std::error_code unknown;
  for (const auto& [input, stamp] : others_)
    if (fs::weakly_canonical(input, unknown) == place) return would_overwrite(place, input);
  return {};
}

HttpAnswer EditSession::save(const Body& body) {
  Members members(body);
  const std::string file = members.text("file");
  const bool overwrites = members.flag("overwrite");
  if (auto fault = members.fault()) return *std::move(fault);
  if (!document_) return refusal(409, no_scene);
  if (file.empty() && options_.file.empty())
    return refusal(422, "the scene has no name yet; give it a file");
  const auto own = own_place(), place = file.empty() ? own : place_of_scene(file);
  if (!place) return refusal(place.error());
  const bool is_own = is_on_disk_ && own && *own == *place;
  const std::string name = file.empty() || is_own ? options_.file : place->string();
  std::error_code unknown;
  if (is_own && !overwrites) {
    const auto has_changed = document_->has_file_changed();
    if (has_changed && *has_changed)
      return refusal(409, fmt::format("{} has changed on the disk", printable(name)));
  } else if (!overwrites && fs::exists(*place, unknown)) {
    return refusal(409, is_there(name));
  }
  if (auto free = check_save(*place); !free) return refusal(free.error());
  const bool writes_plainly = is_own && !overwrites && fs::exists(*place, unknown);
  const auto saved = writes_plainly ? document_->save() : document_->save_as(name);
  if (!saved) return refusal(saved.error());
  const bool is_renamed = options_.file != name;
  options_.file = name;
  is_on_disk_ = true;
  is_gone_ = is_changed_on_disk_ = false;
  if (journal_) journal_->clear();
  if (is_renamed) open_journal();
  journaled_ = {revision_, true};
  stamp_ = own_stamp();
  return changed({.name = "save"});
}

HttpAnswer EditSession::load(const Body& body) {
  if (auto fault = Members(body).fault()) return *std::move(fault);
  if (!document_ || !is_on_disk_) return refusal(409, "there is no file to load");
  if (const auto place = own_place(); !place) return refusal(place.error());
  const auto change = document_->load();
  if (!change) return refusal(change.error());
  is_changed_on_disk_ = false;
  stamp_ = own_stamp();
  return changed(*change);
}

Begun EditSession::begin(const Body& body) {
  Members members(body);
  const std::string starter = members.required_text("starter"), material = members.text("material"),
                    mesh = members.text("mesh"), object = members.text("object");
  if (auto fault = members.fault()) return *std::move(fault);
  std::string mesh_there;
  if (!mesh.empty()) {
    const auto place = place_of(mesh);
    if (!place) return refusal(place.error());
    mesh_there = place->string();
  }
  const fs::path file = options_.file.empty() ? "scene.xml" : options_.file;
  const std::string name = (folder_of_file() / file.filename()).string();
  return LongWork([=, this](const SimulationOptions&) {
    const auto beginning = options_.tools.begin(starter, material, mesh_there, object, name);
    return finish(beginning,
                  [this, name](const Beginning& with) { return begin_with(with, name); });
  });
}

// In place of what is there, or as the first.
HttpAnswer EditSession::begin_with(const Beginning& beginning, const std::string& name) {
  for (const auto& [file, bytes] : beginning.files) {
    std::error_code unknown;
    const bool is_file = fs::is_regular_file(file, unknown);
    const auto known = is_file ? read_file(file, bytes.size()) : Result<std::string>("");
    if (is_file && known && *known == bytes) continue;
    if (fs::exists(file, unknown))
      return refusal(422, fmt::format("{} is there already, with other content; move it away",
                                      printable(file)));
    if (auto written = write_file(file, bytes); !written) return refusal(written.error());
  }
  if (document_) {
    const auto change = document_->replace(beginning.text, "begin");
    return change ? changed(*change) : refusal(change.error());
  }
  auto document =
      SceneDocument::from_text(beginning.text, options_.file.empty() ? name : options_.file,
                               folder_of_file(), document_options());
  if (!document) return refusal(document.error());
  start(*std::move(document), false);
  return changed({.name = "begin"});
}

HttpAnswer EditSession::open_file(const Body& body) {
  Members members(body);
  const std::string file = members.required_text("file");
  if (auto fault = members.fault()) return *std::move(fault);
  if (document_) return refusal(409, "there is a scene already");
  const auto place = place_of(file);
  if (!place) return refusal(place.error());
  // A link keeps its name: the scene's files are relative to its folder.
  const std::string name = (fs::path(options_.root) / file).lexically_normal().string();
  auto document = SceneDocument::open(name, document_options());
  if (!document) return refusal(document.error());
  options_.file = name;
  open_journal();
  start(*std::move(document), true);
  return changed({.name = "begin"});
}

HttpAnswer EditSession::restore(const Body& body) {
  if (auto fault = Members(body).fault()) return *std::move(fault);
  if (!journal_ || !journal_->left()) return refusal(409, "the journal has nothing to restore");
  const std::string text = journal_->left()->text;
  if (!document_) {
    auto document = SceneDocument::from_text(
        text, options_.file.empty() ? options_.root + "/scene.xml" : options_.file,
        folder_of_file(), document_options());
    if (!document) return refusal(document.error());
    start(*std::move(document), false);
    take_left();
    return changed({.name = "begin"});
  }
  const auto change = document_->replace(text, "restore");
  if (!change) return refusal(change.error());
  HttpAnswer answer = changed(*change);
  take_left();
  return answer;
}

// Its file stays until its text is in ours.
void EditSession::take_left() {
  write_journal();
  if (journaled_.first == revision_)
    journal_->take_left();
  else
    journal_->forget_left();
}

HttpAnswer EditSession::discard(const Body& body) {
  if (auto fault = Members(body).fault()) return *std::move(fault);
  if (journal_) journal_->take_left();
  return changed({.name = "discard"});
}

Json EditSession::takes() const {
  Json takes = Json::array();
  for (const Take& take : takes_.all())
    takes.push_back(
        {{"id", take.id}, {"name", take.name}, {"hasPicture", take.picture != nullptr}});
  return {{"takes", std::move(takes)}, {"readAgain", read_again_}};
}

HttpAnswer EditSession::keep(const Body& body) {
  Members members(body);
  const std::string name = members.text("name"), digits = members.text("picture");
  if (auto fault = members.fault()) return *std::move(fault);
  if (!document_) return refusal(409, no_scene);
  auto picture = picture_from(digits, options_.simulation.should_stop);
  if (!picture) return refusal(picture.error());
  const auto id = takes_.keep(name, document_->text(), *std::move(picture));
  if (!id) return refusal(id.error());
  return changed({.name = "keep"}, {{"take", *id}});
}

HttpAnswer EditSession::take(const Body& body) {
  Members members(body);
  const auto id = members.whole("id");
  if (!id) members.refuse("id", "is missing");
  const std::string name = members.text("name"), file = members.text("file");
  const bool overwrites = members.flag("overwrite"), deletes = members.flag("delete"),
             is_ghost = members.flag("ghost");
  const auto has = [&](const char* member) { return body.contains(member); };
  if (has("name") + has("file") + has("delete") + has("ghost") > 1)
    members.refuse("name, file, delete, ghost", "must not come together");
  if (has("overwrite") && !has("file")) members.refuse("overwrite", "needs a file");
  if (has("delete") && !deletes) members.refuse("delete", "must be true");
  if (is_ghost) members.refuse("ghost", "must be false");
  if (auto fault = members.fault()) return *std::move(fault);
  const Take* const take = takes_.find(*id);
  if (!take) return refusal(422, no_take(*id));
  if (has("file")) return save_take(*take, file, overwrites);
  if (has("name")) {
    if (auto renamed = takes_.rename(*id, name); !renamed) return refusal(renamed.error());
    return changed({.name = "rename take"});
  }
  if (deletes || has("ghost")) {
    ghosts_.end(*id);
    if (deletes) takes_.remove(*id);
    return changed({.name = deletes ? "delete take" : "ghost"});
  }
  const auto change = document_->replace(take->text, "open " + take->name);
  return change ? changed(*change) : refusal(change.error());
}

HttpAnswer EditSession::save_take(const Take& take, const std::string& file, bool overwrites) {
  const auto place = place_of_scene(file);
  if (!place) return refusal(place.error());
  std::error_code unknown;
  if (!overwrites && fs::exists(*place, unknown)) return refusal(409, is_there(place->string()));
  if (auto free = check_save(*place); !free) return refusal(free.error());
  auto written = check_scene_place(take.text, document_->file(), document_->folder(),
                                   place->string(), options_.simulation.should_stop);
  if (written) written = write_file(place->string(), take.text);
  if (!written) return refusal(written.error());
  return changed({.name = "save take"});
}

Result<const Ghost*> EditSession::ghost(std::int64_t id) {
  if (const Ghost* const known = ghosts_.find(id)) return known;
  const Take* const take = takes_.find(id);
  if (!take) return fail(ErrorCode::InvalidInput, no_take(id));
  auto scene = parse_scene(take->text, document_->file(), document_->folder(), options_.root,
                           options_.simulation.should_stop);
  if (!scene) return fail(scene.error());
  return &ghosts_.begin(id, *std::move(scene));
}

Begun EditSession::add(const Body& body) {
  Members members(body);
  NewObject wanted{.kind = members.required_text("kind"),
                   .surface = members.text("surface"),
                   .group = members.text("group"),
                   .file = members.text("file"),
                   .object = members.text("object")};
  if (auto fault = members.fault()) return *std::move(fault);
  if (!document_) return refusal(409, no_scene);
  if (!wanted.file.empty()) {
    const auto place = place_of(wanted.file);
    if (!place) return refusal(place.error());
    wanted.file = place->lexically_relative(folder_of_file()).string();
  }
  return LongWork([this, wanted, document = *document_](const SimulationOptions& options) {
    return finish(to_add(document, wanted, options), [this](const Addition& addition) {
      return step(addition.operations, fmt::format("add {}", addition.name), "",
                  {{"object", addition.name}});
    });
  });
}

Begun EditSession::material(const Body& body) {
  Members members(body);
  const std::string surface = members.required_text("surface"),
                    material = members.required_text("material");
  if (auto fault = members.fault()) return *std::move(fault);
  if (!document_) return refusal(409, no_scene);
  return LongWork([=, this, document = *document_](const SimulationOptions&) {
    const auto text = options_.tools.material(document, surface, material);
    return finish(text, [=, this](const std::string& changed_text) {
      const auto change =
          document_->replace(changed_text, fmt::format("{} as {}", surface, material));
      return change ? changed(*change) : refusal(change.error());
    });
  });
}

Begun EditSession::motion(const Body& body) {
  Members members(body);
  const MotionGoals goals{.surface = members.text("surface"),
                          .peak = members.number("peak"),
                          .settling = members.number("settling"),
                          .frequency = members.number("frequency")};
  const std::string gesture = members.text("gesture");
  if (auto fault = members.fault()) return *std::move(fault);
  if (!document_) return refusal(409, no_scene);
  return LongWork([=, this, scene = document_->scene()](const SimulationOptions& options) {
    const auto simulation = Simulation::make(scene, options);
    const auto suggestion = simulation ? suggest_material(*simulation, goals, options)
                                       : Result<Suggestion>(fail(simulation.error()));
    return finish(suggestion, [=, this](const Suggestion& found) {
      const std::string name = "motion" + (goals.surface.empty() ? "" : " of " + goals.surface);
      return step(operations_for(found, document_->scene()), name, gesture,
                  {{"reached", reached_by(found)}});
    });
  });
}

void EditSession::tick() {
  if (!document_) return;
  const auto now = Clock::now();
  ghosts_.end_idle(now);
  if (now - looked_ >= between_looks) {
    looked_ = now;
    look_at_disk();
  }
  if (now - written_ >= between_journals) {
    written_ = now;
    write_journal();
  }
}

void EditSession::flush() {
  if (document_) write_journal();
}

// A file that the scene reads is another one: the text is the same, what it means is not.
void EditSession::read_others_again() {
  ++revision_;
  ++read_again_;
  ghosts_.end_all();
  if (auto read = document_->refresh(); read)
    return play();
  else
    solver_.refuse(revision_, read.error());
}

// Whether a file is another one than `known`, and is not being written any more.
bool EditSession::is_new(const fs::path& file, FileStamp now, FileStamp& known) {
  const auto before = unsettled_.find(file);
  if (now == known) {
    if (before != unsettled_.end()) unsettled_.erase(before);
    return false;
  }
  if (before == unsettled_.end() || before->second != now) {
    unsettled_[file] = std::move(now);
    return false;
  }
  unsettled_.erase(before);
  known = std::move(now);
  return true;
}

// Without changes of its own the document follows its file; with them somebody must decide.
void EditSession::look_at_disk() {
  bool are_others_new = false;
  for (auto& [file, stamp] : others_)
    are_others_new = is_new(file, stamp_of(file), stamp) || are_others_new;
  if (are_others_new) read_others_again();
  if (!is_on_disk_ || !is_new(document_->file(), own_stamp(), stamp_)) return;
  const bool was_gone = std::exchange(is_gone_, stamp_.empty());
  const auto has_changed = is_gone_ ? Result<bool>(false) : document_->has_file_changed();
  if (!has_changed) return;
  if (*has_changed) ++disk_count_;
  const bool was_saved = document_->is_saved();
  const bool was_changed = std::exchange(is_changed_on_disk_, *has_changed);
  if (*has_changed && was_saved) {
    if (const auto change = document_->load()) {
      is_changed_on_disk_ = false;
      (void)changed(*change);
      return;
    }
  }
  if (is_changed_on_disk_ || was_changed || is_gone_ != was_gone) notify_();
}

void EditSession::write_journal() {
  const std::pair now(revision_, is_saved());
  if (!journal_ || journaled_ == now) return;
  Result<void> written;
  if (is_saved())
    journal_->clear();
  else
    written = journal_->write(document_->text());
  if (written) journaled_ = now;
  const std::string fault = written ? "" : written.error().message;
  if (std::exchange(journal_fault_, fault) != fault) notify_();
}

}  // namespace pliant::editor
