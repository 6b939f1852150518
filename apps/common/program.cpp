#include "apps/common/program.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <system_error>

#include "apps/common/command_line.h"
#include "apps/common/progress.h"
#include "weft/core/nearest_name.h"
#include "weft/error.h"

namespace weft::engine::app {
namespace {

/// Reopens standard streams that the caller has closed, so that later files do not take their descriptors.
/// Writes to a closed standard output fail; those to a closed standard error are lost.
void fill_standard_streams() {
  for (const int stream : {0, 1, 2}) {
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", stream == 2 ? O_WRONLY : O_RDONLY);
  }
}

/// Reports the first word that is not a command, with a suggestion. CLI11 would only request a command.
void require_commands(const CLI::App& app, int argc, char** argv) {
  const CLI::App* parent = &app;
  std::string path = app.get_name();
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    std::vector<std::string> names;
    const CLI::App* chosen = nullptr;
    for (const CLI::App* command : parent->get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(command->get_name());
      if (command->get_name() == argv[i]) chosen = command;
    }
    if (names.empty()) return;
    if (!chosen) {
      const std::string nearest = find_nearest(argv[i], names);
      const std::string hint = nearest.empty() ? fmt::format("available: {}", fmt::join(names, ", "))
                                               : fmt::format("did you mean \"{}\"?", nearest);
      throw InputError(
          fmt::format("{} has no command \"{}\"; {} (see {} --help)", path, argv[i], hint, path));
    }
    parent = chosen;
    path += " " + chosen->get_name();
  }
}

int parse(CLI::App& app, int argc, char** argv, int& exit_code) {
  try {
    require_commands(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kBadInput;
  } catch (const weft::InputError& error) {
    say(error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    if (!std::ferror(stdout)) say(fmt::format("weft: {}", error.what()));
    return kSimulationFailed;
  }
  return exit_code;
}

/// Flushes standard output; false, with a message, if not all of it could be written.
bool finish_standard_output() {
  errno = 0;
  const bool had_failed = std::ferror(stdout) != 0;
  if (std::fflush(stdout) == 0 && !had_failed) return true;
  const std::string reason = errno != 0 ? ": " + std::generic_category().message(errno) : "";
  say("weft: standard output cannot be written" + reason);
  return false;
}

}  // namespace

int run_program(CLI::App& app, int argc, char** argv, int& exit_code) {
  fill_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the size limit (ulimit -f) is a write error
  const int result = parse(app, argc, argv, exit_code);
  if (finish_standard_output()) return result;
  return interrupted() ? kInterrupted : kBadInput;  // a closed terminal also closes standard output
}

}  // namespace weft::engine::app
