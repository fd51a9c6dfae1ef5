#include <gtest/gtest.h>

#include "tests/projects/file/flipped_bits_test.h"
#include "tests/projects/file/kill_test.h"

namespace seamwright {

TEST(KillLong, Kills) {
    kill_while_appending(40, 2, false);
}

TEST(KillLong, KillsWithWriteAheadLog) {
    kill_while_appending(40, 4, true);
}

TEST(FlippedBitsLong, OfTheFile) {
    flip_bits_of_the_file(600, 3);
}

TEST(FlippedBitsLong, OfTheRows) {
    flip_bits_of_the_rows(2500, 4);
}

}  // namespace seamwright
