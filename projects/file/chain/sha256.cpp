#include "projects/file/chain/sha256.h"

#include <fmt/format.h>
#include <sodium.h>

#include <iterator>

namespace seamwright {

struct Sha256::State {
    crypto_hash_sha256_state of;
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
    crypto_hash_sha256_init(&state_->of);
}
Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
    crypto_hash_sha256_update(&state_->of, reinterpret_cast<const unsigned char*>(bytes.data()),
                              bytes.size());
}
void Sha256::add(std::span<const std::byte> bytes) {
    crypto_hash_sha256_update(&state_->of, reinterpret_cast<const unsigned char*>(bytes.data()),
                              bytes.size());
}

Digest Sha256::finish() {
    Digest digest;
    crypto_hash_sha256_final(&state_->of, reinterpret_cast<unsigned char*>(digest.data()));
    return digest;
}

Digest sha256(std::string_view bytes) {
    Digest digest;
    crypto_hash_sha256(reinterpret_cast<unsigned char*>(digest.data()),
                       reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    return digest;
}

std::string hex(std::span<const std::byte> bytes) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string out;
    out.reserve(2 * bytes.size());
    for (const std::byte byte : bytes) {
        out += digits[std::to_integer<std::size_t>(byte >> 4)];
        out += digits[std::to_integer<std::size_t>(byte & std::byte{15})];
    }
    return out;
}

void append_netstring(std::string& out, std::string_view bytes) {
    fmt::format_to(std::back_inserter(out), "{}:", bytes.size());
    out += bytes;
    out += ',';
}

}  // namespace seamwright
