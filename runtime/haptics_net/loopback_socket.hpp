// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "formats/core/result.hpp"

namespace souple {

/// Datagrams on 127.0.0.1 and nowhere else. Sends and receives never wait, allocate or throw.
class LoopbackSocket {
 public:
  /// Port 0: one that is free. Issue device_port_unavailable.
  static Result<LoopbackSocket> open(std::uint16_t port);
  LoopbackSocket(LoopbackSocket&& other) noexcept;
  LoopbackSocket& operator=(LoopbackSocket&& other) noexcept;
  LoopbackSocket(const LoopbackSocket&) = delete;
  LoopbackSocket& operator=(const LoopbackSocket&) = delete;
  ~LoopbackSocket();

  std::uint16_t port() const { return port_; }

  struct Datagram {
    std::size_t size = 0;    ///< of the datagram, of which the buffer may hold less
    std::uint16_t from = 0;  ///< port
  };
  /// Nothing there: no value.
  std::optional<Datagram> receive(std::span<std::byte> buffer);
  /// False: the system did not take it, and it is lost.
  bool send(std::span<const std::byte> bytes, std::uint16_t to_port);

 private:
  LoopbackSocket(int descriptor, std::uint16_t port) : descriptor_(descriptor), port_(port) {}
  int descriptor_ = -1;
  std::uint16_t port_ = 0;
};

}  // namespace souple
