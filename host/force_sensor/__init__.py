"""A force sensor beside a device that measures no force."""
