// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

/// What `knotreel batch` works on.
namespace knotreel::cli::batch {

/// One input and the file that is made of it.
struct Item {
  std::string input;
  std::string output;
};

/// Where the inputs of a batch come from and where its outputs go.
struct Places {
  std::string input;               ///< a folder; a text file with one path per line, `-`: standard input
  std::string output;              ///< folder of the outputs
  std::string extension = ".tcb";  ///< of the outputs
  bool clips_only = false;         ///< leave the pictures in a folder out
  bool recursive = false;  ///< with the folders in the input folder, which come again in the output folder
};

/// All items: those of a folder in natural order (a2 before a10), those of a list in its own order, each
/// once. An output is called as its input with another extension instead of its own. Inputs that would get
/// the same output all keep their extension (a.png.tcb, a.jpg.tcb); what is still the same gets -2, -3, ...
/// in order.
/// @throws Error{kInput} if the folder or list cannot be read, or nothing is in it.
std::vector<Item> find_items(const Places& places);

}  // namespace knotreel::cli::batch
