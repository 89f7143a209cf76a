"""Pages of HTML: self-contained files, and a server of one page that is watched."""
