#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "editor/live_page.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/states/state_store.hpp"

namespace pliant::editor {

/// The number of a text of the document: higher for each change, of undo too.
using Revision = std::int64_t;

/// What is asked of a revision.
struct FrameQuestion {
  enum class Kind {
    Frame,    ///< positions, see `positions_bytes`
    Scene,    ///< what a page draws of it, see `LivePage`
    Details,  ///< regions and what touches, at a frame
  };
  Kind kind = Kind::Frame;
  Revision revision = 0;
  int frame = 0;
};

/// Null: the question is about a revision that is not, or no more, the newest.
using FrameAnswer = std::optional<Result<std::shared_ptr<const std::string>>>;

/// Frames that are solved, as ranges from a first to a last one.
struct ReadyFrames {
  Revision revision = 0;
  std::vector<std::pair<int, int>> ranges;
  friend bool operator==(const ReadyFrames&, const ReadyFrames&) = default;
};

/// Plays the newest revision of a scene in a thread of its own: the frames that are asked for, the
/// last one first, and a while after the last change all others. A run that is out of date stops;
/// one gives way to an earlier frame that is asked for meanwhile. Thread-safe.
class FrameSolver {
 public:
  struct Options {
    SimulationOptions simulation = {};  ///< threads and memory; the rest is ours
    /// Called in the solver's thread when `ready` or `failure` has changed.
    std::function<void()> notify = {};
    /// Its states and shapes are used, and it goes first; outlives this. Null: there is none.
    FrameSolver* leader = nullptr;
  };

  explicit FrameSolver(Options options);
  FrameSolver(const FrameSolver&) = delete;
  FrameSolver& operator=(const FrameSolver&) = delete;
  ~FrameSolver();  ///< stops; what waits for an answer gets none

  /// Plays another scene. Questions about revisions before it are answered by null.
  void take(Revision revision, Scene scene);

  /// There is another revision, which cannot be played.
  void refuse(Revision revision, Error error);

  /// Calls `reply` once, in any thread, at once or when the answer is there.
  void ask(const FrameQuestion& question, std::function<void(FrameAnswer)> reply);

  /// The arrays of a shape that an answer to `Scene` named; null: there is none.
  std::shared_ptr<const std::string> shape(const std::string& key) const;

  ReadyFrames ready() const;
  Revision revision() const;  ///< the newest
  /// Why the newest revision cannot be played on from some frame; null: it can.
  std::optional<Error> failure() const;

  Shelf& shelf() { return caches_.shelf; }

  /// Memory that others may have while it is lent: the farthest frames give way to them.
  std::size_t lendable() const { return frame_part_ / 4 * 3; }
  void lend(bool is_lent);

 private:
  struct Waiting {
    FrameQuestion question;
    std::function<void(FrameAnswer)> reply;
    std::int64_t number = 0;  // in the order in which they were asked; 0: nobody asked
  };
  struct Newest {
    Revision revision = 0;
    Scene scene;
  };
  struct Failure {
    Error error;
    std::optional<int> from;  // the first frame that is known to fail; null: all fails
  };
  struct Caches {
    explicit Caches(std::size_t bytes_each) : store(bytes_each), shelf(bytes_each) {}
    MemoryStateStore store;
    Shelf shelf;
  };
  using Clock = std::chrono::steady_clock;
  using Lock = std::unique_lock<std::mutex>;

  void run();
  Result<void> play(const Newest& newest);
  std::optional<Waiting> next(Revision revision);
  bool put_back(const Waiting& waiting);
  std::optional<int> next_unsolved() const;
  Result<std::shared_ptr<const std::string>> answer(Simulation& simulation,
                                                    const FrameQuestion& question,
                                                    const StopRequest& should_stop);
  Result<std::shared_ptr<const std::string>> frame(Simulation& simulation, Revision revision,
                                                   int number);
  void keep(Revision revision, int number, std::shared_ptr<const std::string> bytes);
  void fail_from(std::optional<int> frame, Revision revision, const Error& error);
  bool fails(const FrameQuestion& question) const;
  bool is_outdated(Revision revision) const;
  bool should_stop(Revision revision) const;
  bool is_wanted() const;
  void drop_frames();
  void tell(bool at_once);

  Options options_;
  std::unique_ptr<Caches> own_caches_;  // null: there is a leader
  Caches& caches_;
  std::size_t frame_part_;  // of the memory
  Frame reused_;            // of the solver's thread, as the next ones
  LivePage page_;
  Clock::time_point told_ = {};

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::optional<Newest> newest_;  // that was not begun
  Revision revision_ = 0;
  Clock::time_point taken_ = {};
  std::list<Waiting> waiting_;
  std::int64_t asked_ = 0;   // questions so far
  int reached_for_ = 0;      // the frame that is being solved
  std::int64_t reason_ = 0;  // the number of the question about it
  int wanted_ = 0;           // the frame asked for last: the page's playhead
  std::map<int, std::shared_ptr<const std::string>> frames_;  // of the newest revision
  std::size_t frame_bytes_ = 0;
  bool is_lent_ = false;
  bool is_answering_ = false;  // what somebody asked
  std::vector<bool> solved_;   // of each frame of the scene
  int first_ = 0;
  std::optional<Failure> failure_;
  bool is_ending_ = false;
  std::thread thread_;  // last, so that it ends before the members it uses
};

}  // namespace pliant::editor
