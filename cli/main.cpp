// The command `pliant`. It uses the public API only; each subcommand has its own file.

#include <exception>
#include <new>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/commands/bake.hpp"
#include "cli/commands/curve_exchange.hpp"
#include "cli/commands/curves.hpp"
#include "cli/commands/format.hpp"
#include "cli/commands/info.hpp"
#include "cli/commands/replay.hpp"
#include "cli/commands/suggest.hpp"
#include "cli/commands/validate.hpp"
#include "cli/edit/edit.hpp"
#include "cli/new/new.hpp"
#include "cli/sweep/sweep.hpp"
#include "cli/terminal/complete.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/keeper.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/usage.hpp"
#include "cli/view/view.hpp"

namespace {

using namespace pliant::cli;
using pliant::printable;

int run(int count, char* arguments[]) {
  CLI::App app(
      "pliant: elastic animation of surfaces under several forces.\n"
      "Scenes are XML; docs/scene-format.md describes them.",
      "pliant");
  app.set_version_flag("--version", "pliant " PLIANT_VERSION);
  app.require_subcommand(1);

  BakeOptions bake;
  add_bake(app, bake);
  CurvesOptions curves;
  add_curves(app, curves);
  ValidateOptions validate;
  add_validate(app, validate);
  InfoOptions info;
  add_info(app, info);
  FormatOptions format;
  add_format(app, format);
  SuggestOptions suggest;
  add_suggest(app, suggest);
  SweepOptions sweep;
  add_sweep(app, sweep);
  ReplayCommandOptions replay;
  add_replay(app, replay);
  ViewOptions view;
  add_view(app, view);
  EditOptions edit;
  add_edit(app, edit);
  CurveExchangeOptions importing;
  add_import(app, importing);
  CurveExchangeOptions exporting;
  add_export(app, exporting);
  NewOptions create;  // behind view: "vew" is rather that than "new"
  add_new(app, create);
  HelpOptions help;
  add_help(app, help);

  if (count > 1 && arguments[1] == completion_request) {
    return run_complete(app, {arguments + 2, arguments + count});
  }
  try {
    app.parse(count, arguments);
  } catch (const CLI::Success& success) {  // --help, --version
    std::ostringstream text;
    const int code = app.exit(success, text, text);
    print(stdout, text.str());
    return code;
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error);
  }
  if (app.got_subcommand("help")) return run_help(app, help);
  if (app.got_subcommand("new")) return run_new(create);
  if (app.got_subcommand("curves")) return run_curves(curves);
  if (app.got_subcommand("validate")) return run_validate(validate);
  if (app.got_subcommand("info")) return run_info(info);
  if (app.got_subcommand("format")) return run_format(format);
  if (app.got_subcommand("suggest")) return run_suggest(suggest);
  if (app.got_subcommand("sweep")) return run_sweep(app, sweep);
  if (app.got_subcommand("replay")) return run_replay(app, replay);
  if (app.got_subcommand("view")) return run_view(view);
  if (app.got_subcommand("edit")) return run_edit(edit);
  if (app.got_subcommand("import")) return run_import(importing);
  if (app.got_subcommand("export")) return run_export(exporting);
  return run_bake(bake);
}

}  // namespace

int main(int count, char* arguments[]) {
  // Without what is done at an exit: LeakSanitizer stops the process there, and the SIGCONT of
  // Keeper::end would undo that, so that both wait for ever.
  if (count > 1 && arguments[1] == keeper_request)
    _exit(run_keeper({arguments + 2, arguments + count + 1}));
  own_standard_streams();
  raise_file_limit();
  try {
    return exit_code_after_output(run(count, arguments));
  } catch (const std::bad_alloc&) {
    print(stderr, "pliant: error: out of memory\n");
  } catch (const std::exception& error) {  // from a library; ours returns its errors
    print(stderr, fmt::format("pliant: error: {}\n", printable(error.what())));
  }
  return exit_failed;
}
