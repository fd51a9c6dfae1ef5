#pragma once
// SHA-256 (FIPS 180-4, of libsodium), and the netstrings that say without doubt where a value ends:
// "LENGTH:BYTES,", LENGTH in decimal (D. J. Bernstein, 1997).

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace seamwright {

using Digest = std::array<std::byte, 32>;

class Sha256 {
  public:
    Sha256();
    ~Sha256();
    void add(std::string_view bytes);
    void add(std::span<const std::byte> bytes);
    Digest finish();  // once

  private:
    struct State;
    std::unique_ptr<State> state_;
};
Digest sha256(std::string_view bytes);

std::string hex(std::span<const std::byte> bytes);  // lower case
void append_netstring(std::string& out, std::string_view bytes);

}  // namespace seamwright
