#include "viewer/sweep_table.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "pliant/core/byte_order.hpp"

namespace pliant::viewer {
namespace {

// A column of texts: each text once, in the order of the first row that has it, and its number in
// each row.
class Texts {
 public:
  void add(std::string_view text) {
    const auto [found, is_new] =
        numbers_.try_emplace(std::string(text), static_cast<std::uint32_t>(texts_.size()));
    if (is_new) {
      texts_.push_back(found->first);
      byte_count_ += text.size() + 3;  // with quotes and a comma
    }
    rows_.push_back(found->second);
  }

  std::size_t byte_count() const { return byte_count_ + rows_.size() * sizeof(rows_[0]); }

  Json finish(Arrays& arrays) const {
    Json texts = Json::array();
    for (const std::string_view text : texts_) texts.push_back(text);
    return {{"texts", std::move(texts)}, {"rows", arrays.add(rows_)}};
  }

 private:
  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::vector<std::string_view> texts_;
  std::vector<std::uint32_t> rows_;
  std::size_t byte_count_ = 0;
};

// The columns of texts: the scene, if there are several, and the paths; at last the errors. Of some
// rows only, if it is stopped.
std::vector<Texts> texts_of(const SweepFolder& folder, const SweepStatus& status,
                            const std::vector<std::size_t>& rows, const StopRequest& should_stop) {
  constexpr std::size_t parts_of_text = 32;
  const Takes& takes = folder.sweep().takes();
  const std::vector<std::string>& scenes = folder.request().scenes;
  const std::size_t first = scenes.size() > 1 ? 1 : 0;
  std::vector<Texts> columns(first + takes.paths().size() + 1);
  StopPoll stop(should_stop);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (stop.after(parts_of_text * columns.size())) break;
    const std::size_t take = rows[row];
    if (first > 0) columns.front().add(scenes[takes.scene_of(take)]);
    const auto texts = takes.texts(take);
    for (std::size_t k = 0; k < texts.size(); ++k) columns[first + k].add(texts[k]);
    columns.back().add(status.takes[take].error);
  }
  return columns;
}

constexpr std::size_t bytes_of_measures = 5 * sizeof(double) + 3 * sizeof(std::int32_t) + 17;

std::vector<std::size_t> merged(std::vector<std::size_t> rows,
                                const std::vector<std::size_t>& more) {
  rows.insert(rows.end(), more.begin(), more.end());
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

template <class Number, class Member>
Json measure(const SweepStatus& status, const std::vector<std::size_t>& rows, Arrays& arrays,
             const Member& member) {
  std::vector<Number> numbers;
  numbers.reserve(rows.size());
  for (const std::size_t take : rows) numbers.push_back(member(status.takes[take].measures));
  return arrays.add(numbers);
}

}  // namespace

std::vector<std::size_t> evenly_spread(std::size_t count, std::size_t most) {
  const std::size_t chosen = std::min(count, most);
  std::vector<std::size_t> numbers(chosen, 0);
  for (std::size_t k = 1; k < chosen; ++k) numbers[k] = k * (count - 1) / (chosen - 1);
  return numbers;
}

std::vector<std::size_t> table_rows(const SweepFolder& folder, const SweepStatus& status,
                                    const std::vector<std::size_t>& needed,
                                    const StopRequest& should_stop) {
  constexpr std::size_t most_bytes = 13'000'000;
  std::size_t most = most_bytes / bytes_of_measures;
  for (;;) {
    std::vector<std::size_t> rows = merged(evenly_spread(status.takes.size(), most), needed);
    std::size_t bytes = rows.size() * bytes_of_measures;
    for (const Texts& column : texts_of(folder, status, rows, should_stop))
      bytes += column.byte_count();
    if (bytes <= most_bytes || most <= needed.size()) return rows;
    const double share = static_cast<double>(most_bytes) / static_cast<double>(bytes);
    most = std::min(most, rows.size());
    most =
        std::max(static_cast<std::size_t>(0.98 * share * static_cast<double>(most)), needed.size());
  }
}

Json table_json(const SweepFolder& folder, const SweepStatus& status,
                const std::vector<std::size_t>& rows, Arrays& arrays,
                const StopRequest& should_stop) {
  std::vector<std::uint32_t> takes;
  std::string states, hashes;
  for (const std::size_t take : rows) {
    const TakeRecord& record = status.takes[take];
    takes.push_back(static_cast<std::uint32_t>(take));
    states.push_back(static_cast<char>(record.status));
    for (const std::uint64_t half : {record.measures.hash.high, record.measures.hash.low})
      append_number(hashes, half, std::endian::big);
  }
  std::vector<Texts> texts = texts_of(folder, status, rows, should_stop);
  Json paths = Json::array();
  for (std::size_t k = 0; k + 1 < texts.size(); ++k) paths.push_back(texts[k].finish(arrays));
  const auto real = [&](double Measures::*member) {
    return measure<double>(status, rows, arrays, [=](const Measures& m) { return m.*member; });
  };
  const auto whole = [&](int Measures::*member) {
    return measure<std::int32_t>(status, rows, arrays,
                                 [=](const Measures& m) { return m.*member; });
  };
  return {{"takes", arrays.add(takes)},
          {"status", arrays.add(states)},
          {"paths", std::move(paths)},
          {"peak", real(&Measures::peak)},
          {"peakFrame", whole(&Measures::peak_frame)},
          {"final", real(&Measures::final)},
          {"rms", real(&Measures::rms)},
          {"speed", real(&Measures::speed)},
          {"energy", real(&Measures::energy)},
          {"settle", whole(&Measures::settle)},
          {"hash", arrays.add(hashes)},
          {"errors", texts.back().finish(arrays)}};
}

}  // namespace pliant::viewer
