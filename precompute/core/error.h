// The ways in which work can end without a result. The command line maps each to its documented exit code.
#pragma once
#include <stdexcept>
#include <string>
#include <utility>

namespace lightwell {

/// The input was rejected (exit code 3): which file, which place in it (a glTF path such as `meshes[3].primitives[0]`), why.
class InputError : public std::runtime_error {
 public:
  InputError(std::string file, std::string place, std::string reason)
      : std::runtime_error(file + (place.empty() ? "" : ": " + place) + ": " + reason),
        file(std::move(file)), place(std::move(place)), reason(std::move(reason)) {}
  std::string file, place, reason;
};

/// The caller asked for something that cannot be meant (exit code 2).
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The work was interrupted on request (exit code 130). Not an error of the input nor of the program.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("interrupted") {}
};

}  // namespace lightwell
