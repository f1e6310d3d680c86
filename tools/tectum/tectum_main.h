// The command line as a function, so that tests call it in-process.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace tectum {

/// Exit statuses of every command.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;   // the circuit is wrong, or does not do what was asked of it
inline constexpr int kExitTrouble = 2;  // a file, camera or servo cannot be reached or used
inline constexpr int kExitUsage = 2;    // the command line is wrong

/// Runs `tectum ARGS…`. `args` leaves out the program's name.
int tectum_main(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

}  // namespace tectum
