// What a program does about its standard streams, and about signals that would end it half-way.
#pragma once

namespace lambent {

/// At the start. Streams that are closed lead nowhere, so that no file of ours gets their number. A reader that has
/// gone, and a file that has reached its limit, make a write fail instead of ending the program.
void prepareStreams();

/// At the end: the exit code, 1 with a line on stderr where something printed did not arrive. A reader that had enough
/// is no error.
int finishStreams(int status);

} // namespace lambent
