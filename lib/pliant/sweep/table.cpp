#include <string>

#include <fmt/format.h>

#include "pliant/sweep/csv.hpp"
#include "pliant/sweep/folder.hpp"

namespace pliant {
namespace {

constexpr std::size_t bytes_at_once = std::size_t{1} << 20U;

std::string_view status_word(TakeStatus status) {
  return status == TakeStatus::Done ? "done" : status == TakeStatus::Failed ? "failed" : "missing";
}

void append_record(const TakeRecord& record, std::string& text) {
  if (record.status == TakeStatus::Done) {
    const Measures& m = record.measures;
    text += fmt::format(",{},{},{},{},{},{},{},{},\n", m.peak, m.peak_frame, m.final, m.rms,
                        m.speed, m.energy, m.settle, to_text(m.hash));
    return;
  }
  text += ",,,,,,,,,";
  text += csv_field(record.error);
  text += '\n';
}

}  // namespace

Result<void> write_table(const Sweep& sweep, const std::vector<std::string>& scenes,
                         const std::vector<TakeRecord>& records,
                         const std::function<Result<void>(std::string_view)>& write) {
  const Takes& takes = sweep.takes();
  std::string text = "take,status";
  if (scenes.size() > 1) text += ",scene";
  for (const VariedPath& path : takes.paths()) text += ',' + csv_field(path.title());
  text += ",peak,peakFrame,final,rms,speed,energy,settle,hash,error\n";
  for (std::size_t take = 0; take < takes.count(); ++take) {
    const TakeRecord none;
    const TakeRecord& record = records.empty() ? none : records[take];
    text += fmt::format("{},{}", take, status_word(record.status));
    if (scenes.size() > 1) text += ',' + csv_field(scenes[takes.scene_of(take)]);
    for (const std::string_view value : takes.texts(take)) text += ',' + csv_field(value);
    append_record(record, text);
    if (text.size() < bytes_at_once) continue;
    if (auto written = write(text); !written) return written;
    text.clear();
  }
  return write(text);
}

std::string title_of(const Sweep& sweep, const std::vector<std::string>& scenes, std::size_t take) {
  const Takes& takes = sweep.takes();
  std::string values;
  const auto add = [&](const std::string& value) {
    if (!values.empty()) values += ", ";
    values += value;
  };
  if (scenes.size() > 1) add("scene=" + scenes[takes.scene_of(take)]);
  const auto texts = takes.texts(take);
  for (std::size_t k = 0; k < texts.size(); ++k)
    add(SceneChange{takes.paths()[k].kind, takes.paths()[k].path, std::string(texts[k])}.typed());
  return printable(fmt::format("take {} ({})", take, values));
}

}  // namespace pliant
