// SPDX-License-Identifier: MIT
#include "runtime/haptics_net/loopback_socket.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace souple {
namespace {

sockaddr_in loopback_address(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

Issue refusal(std::uint16_t port, int error) {
  return make_issue(
      IssueCode::device_port_unavailable,
      "UDP port " + std::to_string(port) + " of 127.0.0.1: " + std::generic_category().message(error));
}

}  // namespace

Result<LoopbackSocket> LoopbackSocket::open(std::uint16_t port) {
  const int descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return refusal(port, errno);
  LoopbackSocket opened(descriptor, port);
  sockaddr_in address = loopback_address(port);
  socklen_t size = sizeof address;
  if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return refusal(port, errno);
  opened.port_ = ntohs(address.sin_port);
  return opened;
}

LoopbackSocket::LoopbackSocket(LoopbackSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), port_(other.port_) {}

LoopbackSocket& LoopbackSocket::operator=(LoopbackSocket&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(port_, other.port_);
  return *this;
}

LoopbackSocket::~LoopbackSocket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::optional<LoopbackSocket::Datagram> LoopbackSocket::receive(std::span<std::byte> buffer) {
  sockaddr_in from{};
  socklen_t size = sizeof from;
  // MSG_TRUNC: the size of the datagram, not of what fitted.
  const ssize_t got = ::recvfrom(descriptor_, buffer.data(), buffer.size(), MSG_TRUNC,
                                 reinterpret_cast<sockaddr*>(&from), &size);
  if (got < 0) return std::nullopt;
  return Datagram{std::size_t(got), ntohs(from.sin_port)};
}

bool LoopbackSocket::send(std::span<const std::byte> bytes, std::uint16_t to_port) {
  const sockaddr_in to = loopback_address(to_port);
  return ::sendto(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL,
                  reinterpret_cast<const sockaddr*>(&to), sizeof to) == ssize_t(bytes.size());
}

}  // namespace souple
