#pragma once
/// The program as a background process, for tests that send it signals.

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace weft::engine {

/// Its standard output and error go to background.txt.
class Background {
 public:
  /// `hangup`: disposition of SIGHUP before the program starts; nohup ignores it.
  explicit Background(std::vector<std::string> arguments, void (*hangup)(int) = SIG_DFL) {
    arguments.insert(arguments.begin(), WEFT_PROGRAM);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    process_ = fork();
    if (process_ == 0) {
      std::signal(SIGHUP, hangup);
      prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends with an aborted test
      if (!std::freopen("background.txt", "w", stdout) || dup2(STDOUT_FILENO, STDERR_FILENO) < 0) _exit(126);
      execv(WEFT_PROGRAM, argv.data());
      _exit(127);
    }
  }

  ~Background() {
    send(SIGKILL);
    wait();
  }

  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// Waits until the program handles the signal; false if it ends without doing so.
  bool catches(int signal) const {
    while (true) {
      const std::string state = status("State:"), mask = status("SigCgt:");
      if (mask.empty() || state == "Z") return false;
      if (std::stoull(mask, nullptr, 16) >> (signal - 1) & 1) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  void send(int signal) const {
    if (process_ > 0) kill(process_, signal);
  }

  /// Its exit code, or -1 if a signal terminated it.
  int wait() {
    if (process_ <= 0) return -1;
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  /// The word after `key` in /proc/PID/status; empty after the process has ended.
  std::string status(const std::string& key) const {
    std::ifstream in("/proc/" + std::to_string(process_) + "/status");
    for (std::string word; in >> word;) {
      if (word == key && in >> word) return word;
    }
    return "";
  }

  pid_t process_ = -1;
};

}  // namespace weft::engine
