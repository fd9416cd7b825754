#include "cli/view/view_picture.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <fstream>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "cli/commands/inputs.hpp"
#include "cli/commands/look.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/terminal/child.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/supervised_program.hpp"
#include "cli/view/view_scene.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "viewer/server.hpp"

namespace pliant::cli {
namespace {

using namespace std::chrono_literals;

constexpr std::array<const char*, 4> browsers = {"chromium", "chromium-browser", "google-chrome",
                                                 "google-chrome-stable"};

tl::unexpected<Error> no_browser(std::string_view option) {
  return fail(ErrorCode::Unwritable, fmt::format("{} needs Chromium to draw the picture (Debian "
                                                 "package chromium); none of {} is on the PATH",
                                                 option, fmt::join(browsers, ", ")));
}

// A headless browser.
Result<SupervisedProgram> open_browser(const std::string& url, const ScratchFolder& folder) {
  const auto* const program = std::find_if(browsers.begin(), browsers.end(), &is_on_path);
  if (program == browsers.end()) return no_browser("--png");
  std::vector<std::string> words = {
      *program, "--headless", "--no-first-run", "--disable-extensions", "--disable-dev-shm-usage",
      "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
      // One process less, and no picture of the window.
      "--in-process-gpu", "--disable-gpu-compositing", "--user-data-dir=" + folder.path()};
  // Chromium does not run as root with its sandbox. It opens only our page.
  if (geteuid() == 0) words.emplace_back("--no-sandbox");
  words.push_back(url);
  return SupervisedProgram::start(std::move(words), {}, folder);
}

// The address of a file, whatever bytes its path has.
std::string address_of(const std::string& path) {
  std::string address = "file://";
  for (const char byte : path) {
    const bool is_plain = (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') ||
                          (byte >= '0' && byte <= '9') || std::strchr("/-._~", byte) != nullptr;
    address +=
        is_plain ? std::string(1, byte) : fmt::format("%{:02X}", static_cast<unsigned char>(byte));
  }
  return address;
}

Result<void> check_frame(const ViewOptions& options, const FrameSpan& frames) {
  const int frame = options.frame.value_or(frames.first);
  if (frame >= frames.first && frame <= frames.last) return {};
  return fail(ErrorCode::InvalidInput,
              fmt::format("--frame {}: must be from {} to {}", frame, frames.first, frames.last));
}

// Up to twelve frames that tell the motion.
std::vector<int> frames_of_sheet(const BakedScene& baked) {
  constexpr int most = 12;
  std::vector<int> chosen = viewer::telling_frames(baked.bake.course, most);
  for (int& frame : chosen) frame += baked.frames.first;
  return chosen;
}

// Writes a page that redirects to `address`. Everyone can see a program's arguments, but the token
// in the address is only for this browser.
Result<std::string> write_way(const std::string& folder, const std::string& address) {
  const std::string path = folder + "/way.html";
  std::ofstream file(path);
  file << fmt::format("<!doctype html>\n<meta http-equiv=\"refresh\" content=\"0;url={}\">\n",
                      address);
  file.close();
  if (!file) return fail(ErrorCode::Unwritable, "cannot write " + path);
  return address_of(path);
}

Result<void> make_picture(const ViewOptions& options, std::string_view page) {
  const auto size = parse_size(options.size);
  if (!size) return fail(size.error());
  if (auto look = check_look(options.look); !look) return look;
  auto scene = read_scene(options.scene, options.root, options.changes);
  if (!scene) return fail(scene.error());
  if (auto free = check_no_input("--png", *options.png, *scene); !free) return free;
  // The options are checked before the scene is run.
  const auto range = parse_frames(options.frames, *scene);
  if (!range) return fail(range.error());
  if (auto frame = check_frame(options, *range); !frame) return frame;
  auto taker = PictureTaker::start(page);
  if (!taker) return fail(taker.error());
  // The browser starts while the scene is baked, unless the motion decides what it draws.
  if (!options.is_sheet) {
    const std::vector<int> frame = {options.frame.value_or(range->first)};
    if (auto ordered = taker->order(frame, *size, options.look); !ordered) return ordered;
  }
  auto baked = bake_scene(*std::move(scene), options, &was_interrupted);
  if (!baked) return fail(baked.error());
  if (options.is_sheet) {
    auto ordered = taker->order(frames_of_sheet(*baked), *size, options.look);
    if (!ordered) return ordered;
  }
  taker->publish(std::move(baked->bake.packed));
  const auto picture = taker->take();
  if (!picture) return fail(picture.error());
  return write_file(*options.png, *picture, &was_interrupted);
}

}  // namespace

// WxH in pixels, at most the size of a canvas.
Result<viewer::PictureSize> parse_size(const std::string& text) {
  constexpr int most = longest_side;
  const std::size_t cross = text.find('x');
  const auto width = to_integer(text.substr(0, cross));
  const auto height =
      cross == std::string::npos ? std::nullopt : to_integer(text.substr(cross + 1));
  if (width && height && std::min(*width, *height) >= 16 && std::max(*width, *height) <= most) {
    return viewer::PictureSize{static_cast<int>(*width), static_cast<int>(*height)};
  }
  return fail(ErrorCode::InvalidInput,
              fmt::format("--size {}: must be WxH, from 16x16 to {}x{}", text, most, most));
}

Result<void> check_browser(std::string_view option) {
  if (std::any_of(browsers.begin(), browsers.end(), &is_on_path)) return {};
  return no_browser(option);
}

struct PictureTaker::State {
  viewer::ViewServer server;
  ScratchFolder folder;
  std::optional<SupervisedProgram> browser = {};  // from the first order on; last, so that it ends
                                                  // before the members it uses
  int orders = 0;
};

PictureTaker::PictureTaker(std::unique_ptr<State> state) : state_(std::move(state)) {}
PictureTaker::PictureTaker(PictureTaker&&) noexcept = default;
PictureTaker::~PictureTaker() = default;

Result<PictureTaker> PictureTaker::start(std::string_view page) {
  auto server = viewer::ViewServer::start(std::string(page), 0);
  if (!server) return fail(server.error());
  auto folder = ScratchFolder::make();
  if (!folder) return fail(folder.error());
  return PictureTaker(std::make_unique<State>(State{*std::move(server), *std::move(folder)}));
}

// A table of frames, each with its number below and one legend for all, or a single frame.
Result<void> PictureTaker::order(const std::vector<int>& frames, viewer::PictureSize size,
                                 const std::string& look, viewer::PictureForm form) {
  constexpr int most_columns = 4;
  const int count = static_cast<int>(frames.size());
  const int label = count > 1 ? 28 : 0;
  const int strip = count > 1 ? 76 : 0;
  const int columns = std::min(most_columns, count);
  const int rows = (count + columns - 1) / columns;
  return order({{"width", size.width},
                {"height", size.height},
                {"frames", frames},
                {"columns", columns},
                {"label", label},
                {"strip", strip},
                {"hasPixels", form == viewer::PictureForm::Pixels},
                {"look", look}},
               {columns * size.width, rows * (size.height + label) + strip}, form);
}

Result<void> PictureTaker::order(viewer::Json job, viewer::PictureSize size,
                                 viewer::PictureForm form) {
  job["number"] = ++state_->orders;
  state_->server.order_picture(
      {job.dump(-1, ' ', false, viewer::Json::error_handler_t::replace), size, form});
  if (state_->browser) return {};
  const auto way = write_way(state_->folder.path(), state_->server.address() + "take");
  if (!way) return fail(way.error());
  auto browser = open_browser(*way, state_->folder);
  if (!browser) return fail(browser.error());
  state_->browser.emplace(*std::move(browser));
  return {};
}

void PictureTaker::publish(std::string packed) { state_->server.publish(std::move(packed)); }

Result<std::string> PictureTaker::take(const std::function<Result<void>()>& check) {
  constexpr auto patience = 120s;
  const auto begin = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - begin < patience) {
    if (was_interrupted()) return interrupted();
    if (auto picture = state_->server.take_picture()) {
      if (*picture) return *std::move(picture);
      return fail(ErrorCode::Unwritable,
                  "Chromium sent an unusable picture: " + picture->error().message);
    }
    if (auto checked = check ? check() : Result<void>(); !checked) return fail(checked.error());
    if (state_->browser->code()) {
      return fail(ErrorCode::Unwritable, "Chromium ended without a picture");
    }
    std::this_thread::sleep_for(2ms);
  }
  return fail(ErrorCode::Unwritable, "Chromium sent no picture within 120 s");
}

void PictureTaker::close() { state_->browser.reset(); }

int picture_view(const ViewOptions& options, std::string_view page) {
  if (auto made = make_picture(options, page); !made) {
    return report(with_kept(made.error(), "no picture was written"));
  }
  if (!options.is_quiet) print(stdout, printable(*options.png) + '\n');
  return exit_done;
}

}  // namespace pliant::cli
