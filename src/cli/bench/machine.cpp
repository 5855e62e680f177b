// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench/machine.h"

#include <stdlib.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include "commit.h"

namespace knotreel::cli::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

Json machine_json() {
  utsname system{};
  uname(&system);
  double load = -1;
  getloadavg(&load, 1);
  return {{"cpu", processor()},
          {"architecture", system.machine},
          {"system", std::string(system.sysname) + " " + system.release},
          {"cores", std::thread::hardware_concurrency()},
          {"memory_bytes", std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGE_SIZE))},
          {"load_before", load}};
}

}  // namespace

Json surroundings_json() {
#ifdef __clang__
  constexpr const char* kCompiler = "clang " __clang_version__;
#else
  constexpr const char* kCompiler = "g++ " __VERSION__;
#endif
  return {{"version", KNOTREEL_VERSION},
          {"commit", KNOTREEL_COMMIT},
          {"date", now_utc()},
          {"machine", machine_json()},
          {"compiler", {{"name", kCompiler}, {"flags", KNOTREEL_BUILD_FLAGS}}}};
}

}  // namespace knotreel::cli::bench
