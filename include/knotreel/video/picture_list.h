// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "knotreel/base/error.h"

namespace knotreel::video {

/// A name with one `%d` or `%0Nd` in it, taken apart.
struct NumberPattern {
  std::string before, after;
  int digits = 0;  ///< least number of digits

  /// The file name with this number, with zeros in front up to `digits`; without the folder.
  std::string name(std::uint64_t number) const;
};

/// @returns none if the file name (not its folder) has not exactly one such part. `%%` stands for `%`.
std::optional<NumberPattern> number_pattern(const std::string& path);

/// Whether it has several such parts, so that it is no pattern, though somebody may have meant one.
bool has_several_numbers(const std::string& path);

/// Whether the name of a file, without its folder, is one of those that a pattern means: by `%d`, or else by
/// `*`, `?` and `[...]`.
bool matches_pattern(const std::string& pattern, const std::string& name);

/// Whether an input means several pictures: a folder, or, unless a file is called so, a pattern.
bool means_pictures(const std::string& input);

/// The files that an input means, in order: by number, or in natural order (a2 before a10). Folders give
/// what has an extension of a picture; hidden files are left out.
/// @throws Error{kInput} if there are none.
std::vector<std::string> list_pictures(const std::string& input);

/// The same for vector documents: folders give those called .tcb. @throws likewise.
std::vector<std::string> list_documents(const std::string& input);

/// How many numbers between the first and the last of list_pictures(input) no picture has; 0 if the input is
/// not a pattern with `%d`.
std::uint64_t missing_numbers(const std::string& input, const std::vector<std::string>& pictures);

}  // namespace knotreel::video
