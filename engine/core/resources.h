// What libraries and drivers need of the machine, and do not say.
#pragma once

namespace lambent {

/// Throws RunError where this process may not make so many more threads, or take the address space or stack, that
/// drivers, Embree and our own loops take: without, they end the program or wait for ever.
void requireResources(int threads);

} // namespace lambent
