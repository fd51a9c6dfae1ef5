#pragma once
// A project file whose bits are turned over one at a time.

#include <cstddef>

namespace seamwright {

// `flips` random bits of the file's bytes and every `header_step`th bit of its header: the file is refused,
// or reading all of it or check() says so, or every value that it holds is read as before.
void flip_bits_of_the_file(int flips, unsigned seed, std::size_t header_step = 1);

// `flips` random bits of random columns of random rows, written through SQLite, so that its own checks see a
// sound file: opening refuses each, and names the checksum or what the value contradicts.
void flip_bits_of_the_rows(int flips, unsigned seed);

}  // namespace seamwright
