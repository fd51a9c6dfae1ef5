#pragma once
// A large value type is copied, moved and destroyed in a hundred sources. Declared in its class and defined beside it, that
// code is compiled once: a source that copies a Project compiled five seconds longer without.
//   struct Spot { SEAM_VALUE_TYPE(Spot); std::string id; ... };     spot.h
//   SEAM_VALUE_TYPE_MEMBERS(Spot)                                    spot.cpp

// NOLINTBEGIN(bugprone-macro-parentheses): T is the name of a type
#define SEAM_VALUE_TYPE(T)      \
    T();                        \
    T(const T&);                \
    T(T&&) noexcept;            \
    T& operator=(const T&);     \
    T& operator=(T&&) noexcept; \
    ~T()

#define SEAM_VALUE_TYPE_MEMBERS(T)           \
    T::T() = default;                        \
    T::T(const T&) = default;                \
    T::T(T&&) noexcept = default;            \
    T& T::operator=(const T&) = default;     \
    T& T::operator=(T&&) noexcept = default; \
    T::~T() = default;
// NOLINTEND(bugprone-macro-parentheses)
