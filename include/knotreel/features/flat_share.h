// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::features {

/// Of some pixels, how many there are by their largest second difference along the row and the column, in any
/// channel. Alpha is one of them: where it bends, there is an edge to draw; where it does not, it changes
/// nothing.
struct DifferenceCounts {
  std::size_t flat = 0;   ///< at most a level
  std::size_t small = 0;  ///< up to eight
  std::size_t large = 0;  ///< the others
  std::size_t sharp = 0;  ///< those of the large ones that are above 64

  std::size_t count() const { return flat + small + large; }
};

/// These of a picture, by which drawings are told from others: what is asked below may be asked of it as
/// well, if it is asked more than once. Pixels at the sides do not count. As flat_share() for threads.
class SecondDifferences {
 public:
  SecondDifferences() = default;
  explicit SecondDifferences(const image::Image& image);
  /// The same, but rows that are as in another picture of the same size are not looked at again.
  /// @param known of that one.
  SecondDifferences(const image::Image& image, const image::Image& before, const SecondDifferences& known);

  DifferenceCounts sum() const;

 private:
  std::vector<DifferenceCounts> rows_;
};

/// Share of the pixels, 0 to 1, at which a picture is flat or a ramp: second differences along the row and
/// the column are at most one level in all channels. Drawings, logos and screenshots have 0.64 and more,
/// photographs 0.01 to 0.04, frames of films, from which codecs take the noise, up to 0.5.
/// Pixels at the sides do not count; 0 if there are no others. Safe to call from several threads; same bits
/// for any number of threads.
double flat_share(const image::Image& image);

/// Whether a picture was drawn, by hand or by a program, rather than photographed: flat_share() is 0.6 or
/// more. Or it is somewhat less, as where photographs, shades or the noise of codecs are in a drawing, but
/// edges are sharp: flat_share() and 0.2 times as many second differences above 64 levels as there are of 8
/// to 64, at most 0.2, are 0.52 together; or 0.43, and 0.4 of the pixels have one of three colours, not
/// black; or 0.22, there are 0.2 times as many of these second differences, and 0.43 of the pixels have one
/// of two colours, not black. Films have up to 0.48, compressed drawings mostly 0.54 and more, those full of
/// lines less. As flat_share() for threads.
bool is_drawing(const image::Image& image);
bool is_drawing(const image::Image& image, const SecondDifferences& of_rows);

/// Whether a picture may be one of a sequence of drawings: 0.42 together is enough, or 0.19 of those full of
/// lines. For pictures behind one that is_drawing(), since noise changes from frame to frame. As flat_share()
/// for threads.
bool may_be_drawing(const image::Image& image);
bool may_be_drawing(const image::Image& image, const SecondDifferences& of_rows);

/// Whether a drawing comes without the noise that codecs leave around edges: of its second differences that
/// are more than a level, few are small. Of drawings by programs 0.02 to 0.4 times as many are up to 8 levels
/// as are larger; of compressed ones 0.9 and more; the bound is 0.6. Shaded and soft ones may count as noisy.
/// As flat_share() for threads.
bool is_clean(const image::Image& image);
bool is_clean(const SecondDifferences& of_rows);

}  // namespace knotreel::features
